"""Outputs and torques within the robot's own messages: over RSI, on loopback, in real time and without a socket."""

import socket
import time
from collections.abc import Iterator
from threading import Event, Thread

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.robot_bench import Addresses, RobotBench
from firmware_sim.robot_cell import cell_controller
from stagectl.link.bus import LinkError
from stagectl.robot.arm import irb140
from stagectl.robot.beside import OutputProgram, ReportedTorques, await_torques, program_of, torques_of
from stagectl.robot.config import CellConfig, Robot, RobotLimits
from stagectl.robot.conversation import PortState, RobotConversation
from stagectl.robot.guard import CommandGuard
from stagectl.robot.port import RobotPort
from stagectl.robot.program import RobotProgram, TorqueSignals
from stagectl.wire.robot import RATE, Motion, Outputs, Report
from stagectl.wire.rsi import Rsi, pack_telegram, unpack_answer
from tests.until import EVER, until

pytestmark = pytest.mark.stall(0.5)
BUSY = 10.0
"""s that anything may take on a busy machine."""
HOME = np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
POSE = np.array([0.5, 0.0, 0.7, 1.0, 0.0, 0.0, 0.0])
KUKA = ("127.0.0.1", 4_000)
CONSTANT = (2.0, 2.0, 2.0, 1.0, 1.0, 0.5)


@pytest.fixture
def cell() -> Iterator[tuple[CellConfig, RobotBench]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    robot = Robot(
        wire="rsi",
        port=port,
        commands=0,
        signals=0,
        silence=250,
        lag=BUSY,
        patience=BUSY,
        torque_constant=CONSTANT,
        late=10**6,
    )
    config = CellConfig(robot=robot)
    bench = RobotBench(cell_controller(config), Addresses(motion=port))
    stop, ready = Event(), Event()
    thread = Thread(target=bench.run, args=(ready.set, stop))
    thread.start()
    assert ready.wait(EVER)
    yield config, bench
    stop.set()
    thread.join()


def test_outputs_and_torques_go_within_the_messages(cell: tuple[CellConfig, RobotBench]) -> None:
    config, bench = cell
    with RobotPort(config) as port, program_of(port) as program, torques_of(port, time.monotonic) as torques:
        assert isinstance(program, OutputProgram)
        assert isinstance(torques, ReportedTorques)
        await_torques(torques, port)
        assert torques.wait(50, BUSY)
        np.testing.assert_allclose(torques.newest[1:7], bench.controller.plant.home, atol=1e-4)
        still = np.mean([bench.controller.torque[0] for _ in range(5)], axis=0)
        assert torques.newest[8] == pytest.approx(2.0 * still[1], rel=0.3)
        program.clamp(True)
        program.clamp(False)
        program.soften([0.0] * 6)
        with pytest.raises(LinkError, match=r"soft servo is 0.5, 0, .* must be 0 over robot.wire rsi"):
            program.soften([0.5, 0, 0, 0, 0, 0])
        with pytest.raises(LinkError, match="a person starts the robot's program at its pendant"):
            program.reset()


def test_an_output_that_is_not_read_back_is_named(cell: tuple[CellConfig, RobotBench]) -> None:
    config, _ = cell
    hasty = config.model_copy(update={"robot": config.robot.model_copy(update={"patience": 0.3})})
    with RobotPort(hasty) as port, pytest.raises(LinkError, match="output block is not 1 within 0.3 s"):
        program_of(port).__enter__().change(True)  # there is no changer


def test_a_robot_whose_rsi_has_ended_is_not_heard_until_a_person_starts_it(
    cell: tuple[CellConfig, RobotBench],
) -> None:
    config, bench = cell
    bench.suffer("trip")
    until(lambda: bench.controller.motion is Motion.STOPPED)
    hasty = config.model_copy(update={"robot": config.robot.model_copy(update={"patience": 0.2})})
    with pytest.raises(LinkError, match="no report from the robot on"), RobotPort(hasty):
        pass
    bench.suffer("start")
    with RobotPort(config) as port:
        assert port.report is not None


def test_a_program_for_poses_does_not_take_back_what_one_for_joints_has_left(
    cell: tuple[CellConfig, RobotBench],
) -> None:
    config, bench = cell
    moved = bench.controller.plant.home.copy()
    with RobotPort(config) as port:
        port.start()
        for n in range(1, 101):
            moved[0] += 1e-4
            port.conversation.wanted.put(moved, moved)
            port.flush()
            assert port.wait(port.skip() + 1, BUSY), n
    poses = config.model_copy(update={"robot": config.robot.model_copy(update={"mode": "pose", "patience": 1.0})})
    with RobotPort(poses) as port:
        assert port.until(lambda: "corrections of the axes are on, must be none" in port.conversation.refused, BUSY)
        rests = bench.controller.asked.copy()
        np.testing.assert_allclose(rests, moved, atol=5e-4)  # it has come to rest a little later
        port.start()
        port.conversation.wanted.put(port.sent, port.sent)
        port.flush()
        port.until(lambda: bool(port.reason), BUSY)
        assert "start the robot's program again" in port.reason
    np.testing.assert_array_equal(bench.controller.asked, rests)


def test_a_make_with_lines_of_its_own_has_them() -> None:
    port = RobotPort(CellConfig())
    assert isinstance(torques_of(port, time.monotonic), TorqueSignals)
    with pytest.raises(LinkError, match="cannot be connected to"):
        program_of(RobotPort(CellConfig(robot=Robot(commands=9))))
    assert not isinstance(OutputProgram(port), RobotProgram)


def telegram(counter: int, base: np.ndarray = HOME) -> bytes:
    report = Report(counter, 0.0, HOME, HOME, POSE, stamp=4 * counter, current=np.zeros(6), outputs=Outputs())
    return pack_telegram(report, base, POSE, np.zeros(6))


def conversation() -> RobotConversation:
    guard = CommandGuard(irb140(), RobotLimits(), "joints")
    return RobotConversation(Robot(wire="rsi"), Rsi(), guard, lambda *_: None)


def following() -> RobotConversation:
    """Return a conversation that follows, after three telegrams."""
    talk = conversation()
    for n in range(3):
        talk.take(telegram(n), KUKA, n / RATE)
        assert talk.give() is not None
    talk.begin()
    return talk


def test_each_telegram_is_answered_once_with_its_ipoc() -> None:
    talk = following()
    for n in range(3, 100):
        talk.take(telegram(n), KUKA, n / RATE)
        talk.wanted.put(HOME, HOME + 1e-6 * n)
        answer = talk.give()
        assert answer is not None
        assert talk.give() is None
        assert unpack_answer(answer)[0] == 4 * n
        np.testing.assert_allclose(unpack_answer(answer)[1], 1e-6 * n, atol=1e-9)
    assert talk.reason == ""


def test_late_doubled_and_foreign_telegrams_are_counted() -> None:
    talk = following()
    talk.take(telegram(3), KUKA, 3 / RATE)
    talk.take(telegram(3), KUKA, 3 / RATE)
    talk.take(telegram(1), KUKA, 3 / RATE)
    talk.take(telegram(4), ("10.0.0.9", 4_000), 4 / RATE)
    assert (talk.counts.late, talk.counts.foreign, talk.counts.received) == (2, 1, 4)
    assert talk.refused == "a datagram of 10.0.0.9, must be of 127.0.0.1"


def test_a_silence_says_what_was_refused() -> None:
    talk = following()
    talk.take(telegram(3).replace(b'A2="', b'A2="nan'), KUKA, 3 / RATE)
    talk.watch(7 / RATE)
    assert talk.reason.startswith(
        "the robot is silent for 0.02 s, must be <= 3 cycles; the last one was refused: Rob: "
    )
    assert talk.counts.garbled == 1


def test_a_set_point_that_moves_and_a_reference_too_far_hold_the_robot() -> None:
    talk = following()
    talk.take(telegram(3, HOME + 0.01), KUKA, 3 / RATE)
    assert talk.reason == "the set-point under RSI's corrections has moved by 0.573 deg, must stay"
    talk = following()
    talk.take(telegram(3), KUKA, 3 / RATE)
    talk.wanted.put(HOME, HOME + 2.0)
    assert talk.give() is not None
    assert talk.reason == "joint 1 is asked to 114.6 deg from where RSI was switched on, must be <= 90 deg"
    assert talk.state is PortState.HOLDING


DAMAGE = st.tuples(st.integers(0, 20), st.integers(0, 700), st.binary(max_size=6), st.integers(0, 6))


@given(st.lists(DAMAGE, max_size=12), st.booleans())
def test_nothing_that_comes_makes_an_exception(damage: list[tuple[int, int, bytes, int]], follows: bool) -> None:
    talk = following() if follows else conversation()
    before = talk.counts.received
    for n, (counter, at, put, left_out) in enumerate(damage):
        whole = telegram(counter)
        talk.take(whole[:at] + put + whole[at + left_out :], KUKA, n / RATE)
        talk.wanted.put(HOME, HOME)
        talk.give()
        talk.watch(n / RATE)
    counts = talk.counts
    assert counts.received - before + counts.garbled + counts.late + counts.foreign == len(damage)
