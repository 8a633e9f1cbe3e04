"""The robot port without its socket: what is lost, late, doubled or missing, each with its name."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from stagectl.robot.arm import irb140
from stagectl.robot.config import Robot, RobotLimits
from stagectl.robot.conversation import PortState, RobotConversation
from stagectl.robot.guard import CommandGuard
from stagectl.wire.egm import Egm, pack_report, unpack_command
from stagectl.wire.robot import RATE, Motion, Report

HOME = np.radians([0.0, 0.0, 0.0, 0.0, 30.0, 0.0])
POSE = np.array([0.5, 0.0, 0.7, 1.0, 0.0, 0.0, 0.0])
ROBOT = ("127.0.0.1", 4_000)


def report(counter: int, **other: Any) -> bytes:
    return pack_report(Report(counter, counter / RATE, HOME, HOME, POSE, **other))


class Line:
    """A conversation with its clock: `cycle` brings a report and a reference, and returns the answer's angles."""

    def __init__(self, mode: str = "joints") -> None:
        self.events: list[Any] = []
        guard = CommandGuard(irb140(), RobotLimits(), mode)
        self.talk = RobotConversation(Robot(), Egm(), guard, lambda *event: self.events.append(event))
        self.now, self.counter = 10.0, 0

    def cycle(self, reference: np.ndarray | None = HOME, data: bytes | None = None) -> np.ndarray | None:
        self.counter += 1
        self.hear(report(self.counter) if data is None else data)
        if reference is not None:
            self.talk.wanted.put(HOME, reference)
        answer = self.talk.give()
        return None if answer is None else unpack_command(answer).joint_angle

    def hear(self, *packets: bytes) -> None:
        self.now += 1 / RATE
        for data in packets:
            self.talk.take(data, ROBOT, self.now)
        self.talk.watch(self.now)

    def follow(self) -> None:
        for _ in range(3):
            self.cycle()
        self.talk.begin()


@pytest.fixture
def line() -> Iterator[Line]:
    made = Line()
    made.follow()
    yield made
    assert len(made.events) <= 1  # a fault is told once


def test_references_go_out_one_for_each_report(line: Line) -> None:
    for n in range(300):
        wanted = HOME + 1e-6 * n
        np.testing.assert_allclose(line.cycle(wanted), wanted, atol=1e-14)
        assert line.talk.give() is None
    assert line.talk.reason == ""
    assert line.talk.counts.received == 303


def test_before_it_follows_the_robot_is_held_where_it_is() -> None:
    line = Line()
    for _ in range(5):
        np.testing.assert_allclose(line.cycle(HOME + 1.0), HOME, atol=1e-14)
    assert line.talk.state is PortState.IDLE


def test_a_robot_silent_for_three_cycles_is_held_and_named(line: Line) -> None:
    line.cycle()
    for _ in range(3):
        line.hear()
    assert line.talk.state is PortState.FOLLOWING
    line.hear()
    assert line.talk.state is PortState.HOLDING
    assert line.talk.reason == "the robot is silent for 0.016 s, must be <= 3 cycles"
    assert line.cycle(HOME + 1e-4) is not None
    np.testing.assert_allclose(line.cycle(HOME + 1e-4), HOME, atol=1e-14)
    line.talk.clear()
    assert line.talk.state is PortState.HOLDING
    line.talk.begin()
    np.testing.assert_allclose(line.cycle(HOME + 1e-4), HOME + 1e-4, atol=1e-14)


def test_a_robot_that_comes_back_elsewhere_is_held_there(line: Line) -> None:
    for _ in range(4):
        line.hear()
    elsewhere = pack_report(Report(1, 0.0, HOME + 0.2, HOME + 0.2, POSE))
    np.testing.assert_allclose(line.cycle(HOME, elsewhere), HOME + 0.2, atol=1e-14)


def test_one_or_two_lost_reports_are_counted_and_three_are_a_fault(line: Line) -> None:
    line.counter += 2
    line.cycle()
    assert (line.talk.counts.lost, line.talk.reason) == (2, "")
    line.counter += 3
    line.cycle()
    assert line.talk.reason == "3 reports from the robot are lost in a row, must be < 3"


def test_late_and_doubled_reports_are_counted_and_not_answered(line: Line) -> None:
    line.cycle()
    sent = line.talk.report
    line.hear(report(line.counter - 2), report(line.counter))
    assert line.talk.counts.late == 2
    assert line.talk.report is sent
    assert line.talk.give() is None


@dataclass
class Mangled:
    """A line of datagrams that loses, delays, swaps and doubles them as a network does, by a seed.

    Parameters
    ----------
    seed : int
    lost, doubled, late : float, 0 to 1, part of them
        A late one comes after the next.
    """

    seed: int = 0
    lost: float = 0.0
    doubled: float = 0.0
    late: float = 0.0
    _waiting: list[bytes] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin to draw."""
        self._rng = np.random.default_rng(self.seed)

    def take(self, data: bytes) -> list[bytes]:
        """Return what comes out as `data` goes in."""
        draw = self._rng.random()
        waiting, self._waiting = self._waiting, []
        if draw < self.lost:
            return waiting
        if draw < self.lost + self.late:
            self._waiting = [data]
            return waiting
        copies = 2 if draw < self.lost + self.late + self.doubled else 1
        return [data] * copies + waiting


def test_a_line_that_mangles_is_followed(line: Line) -> None:
    """Lost, late and doubled by chance: no fault, no step back in what the robot has said, all accounted for."""
    mangled, last = Mangled(3, lost=0.03, doubled=0.05, late=0.05), 0
    for n in range(400):
        line.counter += 1
        line.hear(*mangled.take(report(line.counter)))
        line.talk.wanted.put(HOME, HOME + 1e-7 * n)
        line.talk.give()
        assert line.talk.report is not None
        assert line.talk.report.counter >= last
        last = line.talk.report.counter
    counts = line.talk.counts
    assert line.talk.reason == ""
    assert counts.lost > 5
    assert counts.late > 10
    assert counts.received + counts.lost == last


def test_rubbish_and_strangers_are_counted_and_change_nothing(line: Line) -> None:
    line.hear(b"\xff\x00")
    line.talk.take(report(line.counter + 1), ("10.0.0.9", 4_000), line.now)
    assert (line.talk.counts.garbled, line.talk.counts.foreign) == (1, 1)
    assert line.talk.report is not None
    assert line.talk.report.counter == line.counter


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ({"motors_on": False}, "the robot's motors are off"),
        ({"motion": Motion.STOPPED}, "the robot has left guided motion: STOPPED"),
        ({"motion": Motion.ERROR}, "the robot has left guided motion: ERROR"),
    ],
)
def test_what_the_robot_says_of_itself_is_heard(line: Line, said: dict[str, Any], reason: str) -> None:
    line.cycle(data=report(line.counter + 1, **said))
    assert line.talk.reason == reason


def test_a_report_that_was_long_on_its_way_is_a_fault(line: Line) -> None:
    line.now += 0.008
    line.cycle()
    assert line.talk.reason == ""
    for _ in range(20):
        line.now += 0.003
        line.cycle()
        if line.talk.reason:
            break
    assert "a report from the robot comes 0.0" in line.talk.reason


def test_until_the_first_reference_the_robot_is_held_without_a_fault(line: Line) -> None:
    for _ in range(10):
        np.testing.assert_allclose(line.cycle(None), HOME, atol=1e-14)
    assert line.talk.reason == ""


def test_three_cycles_without_a_reference_are_a_fault(line: Line) -> None:
    line.cycle()
    for _ in range(3):
        assert line.cycle(None) is None
        assert line.talk.reason == ""
    assert line.cycle(None) is not None
    assert line.talk.reason == "no reference for 3 cycles, must be < 3"


def test_a_limit_holds_with_its_reason_whatever_comes_after(line: Line) -> None:
    line.cycle(HOME + 2e-5)
    line.cycle(HOME + 4e-5)
    answers = [line.cycle(np.full(6, np.nan)) for _ in range(2)]
    assert line.talk.reason == "the reference of joint 1 is nan, must be a number"
    assert all(each is not None and np.isfinite(each).all() for each in answers)
    end = [line.cycle(HOME + 1e-4) for _ in range(60)][-1]
    assert end is not None
    assert np.abs(end - HOME).max() < 2e-4


def test_the_first_reason_stays(line: Line) -> None:
    line.talk.latch("the tracker is blind")
    line.cycle(data=report(line.counter + 1, motors_on=False))
    line.talk.latch("and something else")
    assert line.talk.reason == "the tracker is blind"


def test_stopping_is_no_fault(line: Line) -> None:
    line.talk.end()
    for _ in range(5):
        line.hear()
    assert line.talk.reason == ""
