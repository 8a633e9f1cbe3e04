"""The port on loopback: the robot's controller at the other end, cycle for cycle, and what goes wrong on the way."""

import socket
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Literal

import numpy as np
import pytest

from ctlblocks import Graph
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from firmware_sim.plants.robot import RobotPlant
from firmware_sim.robot_controller import RobotController
from firmware_sim.wire_ends import EgmEnd
from stagectl.link.bus import LinkError
from stagectl.link.clock import run_linked
from stagectl.robot.config import CellConfig, Robot
from stagectl.robot.conversation import PortState
from stagectl.robot.port import RobotFault, RobotPort
from stagectl.robot.port_blocks import JointCommand
from stagectl.wire.robot import RATE
from tests.until import EVER

PATIENT = 250
"""Cycles: here the clock is the test's, and a busy machine is no fault."""


class Bench:
    """A robot at one end of a UDP line and the port at the other; the test is the robot's clock."""

    def __init__(self, mode: Literal["joints", "pose"] = "joints", silence: int = PATIENT) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.robot = RobotController(RobotPlant(seed=2), end=EgmEnd())
        self.events: list[Any] = []
        robot = Robot(port=port, mode=mode, silence=silence, lag=5.0, patience=5.0)
        self.port = RobotPort(CellConfig(robot=robot), lambda *event: self.events.append(event))
        self.line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.line.bind(("127.0.0.1", 0))
        self.line.settimeout(5.0)

    def speak(self) -> None:
        self.line.sendto(self.robot.advance() or b"", ("127.0.0.1", self.port.robot.port))

    def cycle(self, tick: Callable[[], None] = lambda: None) -> None:
        """Report, let the host tick, take its answer."""
        heard = self.port.counts.received
        self.speak()
        assert self.port.wait(heard + 1, EVER) or self.port.reason
        tick()
        self.port.flush()
        self.robot.receive(self.line.recv(65_536))

    def cycles(self, count: int, tick: Callable[[], None]) -> None:
        for _ in range(count):
            self.cycle(tick)


@pytest.fixture
def bench() -> Iterator[Bench]:
    yield from _open(Bench())


def _open(made: Bench) -> Iterator[Bench]:
    with made.line:
        made.port._carrier.open()  # noqa: SLF001 (entering would wait for a robot that this thread is)
        try:
            yield made
        finally:
            made.port._carrier.close()  # noqa: SLF001


def graph(bench: Bench, correction: np.ndarray) -> Graph:
    """Return home and a correction, shape (ticks, 6), on their way to the robot."""
    home = np.tile(bench.robot.plant.home, (len(correction), 1))
    names = tuple(f"{name}{n}" for name in "nc" for n in range(6))
    played = Recording(names, ("rad",) * 12, RATE, np.hstack([home, correction]))
    made = Graph(RATE)
    made.add("path", Replay(played, {"nominal": names[:6], "correction": names[6:]}))
    made.add("send", JointCommand(bench.port))
    made.connect("path.nominal", "send.nominal")
    made.connect("path.correction", "send.correction")
    made.prepare()
    return made


def test_some_hundred_cycles_go_round_and_the_robot_does_what_the_graph_says(bench: Bench) -> None:
    ticks = 500
    correction = np.zeros((ticks, 6))
    correction[:, 0] = 1e-3 * np.minimum(np.arange(ticks) / 250, 1.0)
    made = graph(bench, correction)
    for _ in range(5):
        bench.cycle()
    bench.port.start()
    for _ in range(ticks):
        bench.cycle(made.tick)
    assert bench.port.reason == ""
    assert bench.port.state is PortState.FOLLOWING
    assert bench.robot.counts.taken == ticks + 5
    assert (bench.port.counts.lost, bench.port.counts.late, bench.port.counts.unanswered) == (0, 0, 0)
    np.testing.assert_allclose(bench.port.sent, bench.robot.plant.home + correction[-1], atol=1e-12)
    assert abs(bench.robot.motor_angle[0, 0] - correction[-1, 0]) < 1e-4
    assert bench.port.report is not None
    np.testing.assert_allclose(bench.port.report.joint_angle, bench.robot.motor_angle[0], atol=2e-4)


def test_a_limit_stops_the_graph_and_the_robot_and_is_acknowledged_by_a_person(bench: Bench) -> None:
    correction = np.zeros((60, 6))
    correction[40:, 1] = 0.01
    made = graph(bench, correction)
    bench.cycle()
    bench.port.start()
    with pytest.raises(RobotFault, match=r"joint 2 is asked to turn by 143.2 deg/s.*; a person must acknowledge"):
        bench.cycles(60, made.tick)
    assert [event for event, _ in bench.events] == ["robot_fault"]
    with pytest.raises(RobotFault):
        bench.port.start()
    for _ in range(100):
        bench.cycle()
    assert np.abs(bench.robot.motor_angle[0] - bench.robot.plant.home).max() < 1e-4
    with pytest.raises(ValueError, match="must be a person's name"):
        bench.port.acknowledge(" ")
    assert "joint 2" in bench.port.acknowledge("Ada")
    bench.port.start()
    assert bench.port.state is PortState.FOLLOWING


def test_a_reason_from_elsewhere_holds_the_robot(bench: Bench) -> None:
    bench.cycle()
    bench.port.hold("not followed yet: nothing happens")
    assert bench.port.reason == ""
    bench.port.start()
    bench.port.hold("the tracker is blind for 0.2 s")
    assert bench.port.reason == "the tracker is blind for 0.2 s"
    bench.cycle()
    np.testing.assert_allclose(bench.port.sent, bench.robot.plant.home, atol=1e-12)


def test_a_robot_that_falls_silent_is_a_fault_within_real_time() -> None:
    for made in _open(Bench(silence=3)):
        made.cycle()
        made.port.start()
        assert not made.port.wait(10, EVER)
        assert "the robot is silent for 0.0" in made.port.reason
        with pytest.raises(LinkError, match="cannot acknowledge yet: the robot is silent"):
            made.port.acknowledge("Ada")


def test_poses_are_sent_in_pose_mode() -> None:
    for made in _open(Bench("pose")):
        made.cycle()
        report = made.port.report
        assert report is not None
        start = report.pose.copy()
        made.port.start()
        for cycle in range(300):
            wanted = start + np.array([0.0, 5e-4 * min(cycle / 100, 1.0), *np.zeros(5)])
            made.cycle(partial(made.port.conversation.wanted.put, start, wanted))
        assert made.port.reason == ""
        assert made.port.report is not None
        assert abs(made.port.report.pose[1] - start[1] - 5e-4) < 1e-4
        with pytest.raises(ValueError, match="robot.mode is 'pose', must be 'joints'"):
            JointCommand(made.port)


def test_a_port_that_hears_nobody_says_so() -> None:
    config = CellConfig(robot=Robot(port=0, patience=0.05))
    with pytest.raises(LinkError, match=r"no report from the robot on 127.0.0.1:\d+ within 0.05 s"), RobotPort(config):
        pass


def test_a_port_that_is_taken_is_named() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        config = CellConfig(robot=Robot(port=other.getsockname()[1]))
        with pytest.raises(LinkError, match=r"robot.port \d+ cannot be listened to"), RobotPort(config):
            pass


def test_a_graph_of_another_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="must be 1 at 250 as on the wire"):
        run_linked(Graph(10_000.0), RobotPort(CellConfig()), 1)
