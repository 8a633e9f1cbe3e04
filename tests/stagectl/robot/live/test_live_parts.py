"""What a live trial is made of: records and torques brought together, the way over the workpiece, the person asked."""

import gc
import os
import pty
import sys
from collections.abc import Callable, Iterator
from types import ModuleType

import numpy as np
import pytest

from calibration import guided_arm
from ctlblocks import Graph
from rigkit.experiment.part import Part
from rigkit.stop import Stopped
from stagectl.experiments.trials.trial import tool_arm
from stagectl.link.bus import LinkError
from stagectl.link.tell import nobody
from stagectl.robot.config import CellConfig, Robot
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.kinematics import forward
from stagectl.robot.live import way
from stagectl.robot.live.blocks import LiveTorques, LiveTracker
from stagectl.robot.live.force_records import ForceRecords
from stagectl.robot.live.person import Person
from stagectl.robot.live.way import Room, room_of
from stagectl.robot.live.wires import LiveWires
from stagectl.robot.program import TorqueSignals
from stagectl.wire.force_sensor import Record, Status
from stagectl.wire.tracker import Sample, Sighting, pack_sample

HOME = np.array(CellConfig().pocket.home)


def records(*given: tuple[int, int, float]) -> ForceRecords:
    """Return what has taken records of a counter, a status, and the same number on all six axes."""
    made = ForceRecords(ForceSensor())
    for counter, status, value in given:
        made.accept(Record(counter, counter, status, np.full(6, value)), 0.0)
    return made


def test_records_of_a_tick_become_their_mean_and_none_that_is_lost_is_forgotten() -> None:
    made = records((7, 0, 1.0), (8, 0, 3.0))
    taken = made.take()
    assert taken is not None
    assert (taken[0].wrench.tolist(), taken[1]) == ([2.0] * 6, 0)
    assert made.take() is None
    for counter in (11, 12, 12):
        made.accept(Record(counter, counter, 0, np.full(6, 5.0)), 0.0)
    taken = made.take()
    assert taken is not None
    assert (taken[0].wrench.tolist(), taken[1]) == ([5.0] * 6, 2)


def test_after_a_pause_each_report_has_its_records() -> None:
    made = records(*((n, 0, float(n)) for n in range(20)))
    means = [taken[0].wrench[0] for taken in iter(made.take, None) if taken is not None]
    assert means == [2 * n + 0.5 for n in range(10)]
    made = records(*((n, 0, 0.1 * n) for n in range(200)))
    taken = made.take()
    assert taken is not None
    assert taken[0].wrench[0] == pytest.approx(9.95)
    assert made.take() is None


def test_a_sample_of_the_tracker_waits_for_its_tick() -> None:
    wires = LiveWires(CellConfig(), nobody, now=lambda: 0.0)
    wires.tracker_late = 0.5
    block, pose = LiveTracker(wires), np.array([0.5, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0])
    for n, time in enumerate((-0.4999, -0.496), start=1):
        block.samples.take(pack_sample(Sample(n, time + 1.0, (Sighting(7, 3, 1e-4, pose),))), 0.0)
    wires.tracker_late -= 1.0
    block.prepare(2_000.0, 1)
    outputs = [np.zeros((1, port.width)) for port in block.outputs]
    shown = []
    for _ in range(9):
        block.process(*outputs)
        shown.append(float(outputs[0][0, 0]))
    assert shown == [1.0] * 7 + [2.0] * 2
    assert outputs[1][0, 0] == pytest.approx(0.004)
    assert outputs[4][0].tolist() == [0.0, 3.0]  # the spindle's frame was not in it


@pytest.mark.parametrize(("status", "value"), [(int(Status.OUT_OF_RANGE), 1.0), (1, 1.0), (0, 400.0)])
def test_a_record_that_is_saturated_or_faulty_is_not_hidden_by_others(status: int, value: float) -> None:
    taken = records((1, 0, 0.0), (2, status, value), (3, 0, 0.0)).take()
    assert taken is not None
    assert (taken[0].status, taken[0].wrench[0]) == (status, value)


def handed_out(ticks: int, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return stamps and torques of so many ticks, from a line that has these times, s; the trial began at 5 s."""
    signals, wires = TorqueSignals(Robot(), "127.0.0.1", lambda: 0.0), LiveWires(CellConfig(), nobody)
    rows = "".join(",".join(map(str, [time, *[0.0] * 6, *[10.0 * time] * 6])) + "\n" for time in times)
    signals.take(rows.encode(), 0.0)
    wires.signals, wires.begun = signals, 5.0
    block = LiveTorques(wires)
    block.prepare(2000.0, 1)
    stamp, torque = np.zeros((1, 1)), np.zeros((1, 6))
    found = []
    for _ in range(ticks):
        block.process(torque_stamp=stamp, logged_torque=torque)
        found.append((stamp[0, 0], torque[0].copy()))
    stamps, torques = zip(*found, strict=True)
    return np.array(stamps), np.array(torques)


def test_every_sample_of_the_torques_line_is_handed_out_once_by_its_own_time() -> None:
    times = np.arange(5.0, 5.6, 0.004)
    stamp, torque = handed_out(len(times) + 20, times)
    np.testing.assert_allclose(stamp, np.minimum(np.arange(len(times) + 20), len(times) - 1) * 0.004, atol=1e-12)
    np.testing.assert_allclose(torque[:, 5], 50.0 + 10.0 * stamp)


@pytest.fixture(scope="module")
def room() -> Room:
    cell = CellConfig()
    arm = tool_arm(cell)
    return room_of(cell, arm, float(forward(arm, HOME)[2, 3]))


def test_the_way_goes_up_across_and_down_no_faster_than_it_may(room: Room) -> None:
    inside, start = HOME + [0.03, 0.0, 0.01, 0.0, 0.0, 0.0], HOME + [-0.05, 0.0, 0.0, 0.0, 0.0, 0.0]
    way = np.vstack([inside, room.way(inside, start)])
    place = forward(room.arm, way)[:, :3, 3]
    high = place[:, 2] > room.top + 0.99 * room.height
    aside = np.linalg.norm(place[:, :2] - place[0, :2], axis=1), np.linalg.norm(place[:, :2] - place[-1, :2], axis=1)
    assert (np.minimum(*aside)[~high] < 1e-4).all()
    np.testing.assert_allclose(way[-1], start, atol=1e-9)
    assert (np.abs(np.diff(way, axis=0)).max(axis=0) * 250.0 <= room.turn * 1.01).all()
    assert np.linalg.norm(np.diff(place, axis=0), axis=1).max() * 250.0 <= room.speed * 1.01


def test_a_robot_that_is_there_already_stays(room: Room) -> None:
    assert len(room.way(HOME, HOME + 1e-7)) == 1
    np.testing.assert_array_equal(room.up(room.up(HOME)), room.up(HOME))


def test_a_way_that_would_come_too_low_is_refused(room: Room) -> None:
    swing = np.array([0.0, 0.0, 0.0, 0.0, 0.8, 0.0])  # like a pendulum: in the middle it is lowest
    with pytest.raises(ValueError, match="on its way the tool would come down to z = .* move the robot over"):
        room.way(HOME - swing, HOME + swing)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Give a person's end of a terminal that is the standard input."""
    person, program = pty.openpty()
    with os.fdopen(program, "r") as line:
        monkeypatch.setattr(sys, "stdin", line)
        yield person
    os.close(person)


def test_what_was_typed_before_it_is_asked_for_confirms_nothing(terminal: int) -> None:
    os.write(terminal, b"\n")
    looks: list[int] = []

    def stopped() -> bool:
        looks.append(1)
        return len(looks) > 2

    with pytest.raises(Stopped, match="stopped before the robot moved on"):
        Person(print, True).confirm("a fresh block", stopped)


def test_enter_confirms(terminal: int) -> None:
    told: list[str] = []

    def stopped() -> bool:
        if not told[1:]:
            told.append("asked")
            os.write(terminal, b"\n")
        return False

    Person(told.append, True).confirm("a fresh block", stopped)
    assert told == ["a fresh block; then Enter", "asked"]


def test_without_a_terminal_nobody_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull) as nobody:
        monkeypatch.setattr(sys, "stdin", nobody)
        with pytest.raises(ValueError, match="no terminal: nobody can confirm .* --yes goes on"):
            Person(print, True)
        Person(print, False).confirm("a fresh block", lambda: False)


def went() -> None:
    way.go(CellConfig(), lambda here: here[None], nobody, lambda: False)


def led() -> None:
    with guided_arm.led_arm(CellConfig(), False, str, lambda _: Part("", Graph(250.0), (), ())):
        pass


@pytest.mark.parametrize(("module", "opens"), [(way, went), (guided_arm, led)])
def test_garbage_is_searched_for_before_a_robot_waits_for_answers(
    monkeypatch: pytest.MonkeyPatch, module: ModuleType, opens: Callable[[], None]
) -> None:
    """It took 0.15 s, for which the robot had no answer."""
    searched = list[bool]()

    def opened(*_: object) -> None:
        searched.append(not gc.isenabled())
        raise LinkError("the socket")

    monkeypatch.setattr(module, "RobotPort", opened)
    with pytest.raises(LinkError, match="the socket"):
        opens()
    assert searched == [True]
