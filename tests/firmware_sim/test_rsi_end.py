"""The simulated controller under RSI: IPOC, late answers and the stop after too many, limits, outputs."""

from collections.abc import Callable

import numpy as np
import pytest

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.robot_controller import RobotController
from firmware_sim.wire_ends import ENDS, RsiEnd
from stagectl.wire.makes import ROBOTS
from stagectl.wire.robot import Command, Motion, Outputs, Report
from stagectl.wire.rsi import PERIOD, REACH, Rsi


class Bench:
    """A controller that gives up after five late answers, and the host's wire."""

    def __init__(self) -> None:
        self.end = RsiEnd(5)
        self.robot = RobotController(RobotPlant(seed=2, noise=0.0), end=self.end)
        self.wire = Rsi()
        self.home = self.robot.plant.home

    def cycle(self) -> Report:
        telegram = self.robot.advance()
        assert telegram is not None
        return self.wire.read(telegram)

    def answer(self, report: Report, angle: np.ndarray, outputs: Outputs | None = None) -> None:
        self.robot.receive(self.wire.write(Command(0, 0.0, joint_angle=angle, outputs=outputs), report))


def test_every_make_has_an_end_in_the_simulator() -> None:
    assert set(ENDS) == set(ROBOTS)


def test_it_follows_absolute_corrections_and_says_what_it_has_applied() -> None:
    bench, stamps = Bench(), []
    for n in range(250):
        report = bench.cycle()
        stamps.append(report.stamp)
        bench.answer(report, bench.home + 1e-5 * n)
    assert set(np.diff(stamps)) == {PERIOD}
    assert report.overdue == 0
    assert bench.robot.counts.taken == 250
    np.testing.assert_allclose(report.planned_angle, bench.home + 245e-5, atol=5e-5)
    np.testing.assert_allclose(report.joint_angle, report.planned_angle, atol=1e-4)


@pytest.mark.parametrize(
    "late",
    [
        lambda _: [],
        lambda data: [data[:-9]],
        lambda data: [data.replace(b"<IPOC>4", b"<IPOC>3")],
        lambda data: [data.replace(b'A2="', b'A2="nan')],
    ],
    ids=["none", "truncated", "another IPOC", "NaN"],
)
def test_late_answers_are_counted_and_too_many_in_a_row_switch_rsi_off(late: Callable[[bytes], list[bytes]]) -> None:
    bench = Bench()
    for _ in range(3):
        bench.answer(bench.cycle(), bench.home)
    for n in range(6):
        report = bench.cycle()
        assert report.overdue == n
        for data in late(bench.wire.write(Command(0, 0.0, joint_angle=bench.home + 0.1), report)):
            bench.robot.receive(data)
    assert bench.robot.advance() is None
    assert bench.robot.motion is Motion.STOPPED
    assert bench.robot.advance() is None
    assert np.abs(bench.robot.motor_angle - bench.home).max() < 1e-3
    assert bench.robot.do("RESET") == "OK"
    bench.wire.forget()
    assert bench.cycle().overdue == 0


def test_one_answer_a_cycle_counts_and_one_in_time_ends_the_row() -> None:
    bench = Bench()
    for n in range(40):
        report = bench.cycle()
        if n % 5 == 4:
            bench.answer(report, bench.home + 1e-3)
            bench.answer(report, bench.home + 2e-3)
    report = bench.cycle()
    assert (report.overdue, bench.robot.counts.taken, bench.robot.counts.late) == (32, 8, 8)
    np.testing.assert_allclose(bench.robot.asked, bench.home + 1e-3, atol=1e-8)


def test_corrections_beyond_the_limits_are_clamped_without_a_word() -> None:
    bench = Bench()
    far = bench.home.copy()
    far[0] += REACH + 0.2
    for n in range(2_000):
        part = min(1.0, n / 1_500)
        bench.answer(bench.cycle(), bench.home + part * (far - bench.home))
    assert bench.robot.asked[0] - bench.home[0] == pytest.approx(REACH)


def test_outputs_are_switched_and_read_back_and_a_motor_that_trips_ends_it() -> None:
    bench = Bench()
    bench.answer(bench.cycle(), bench.home, Outputs(clamp=True, block=True))
    assert bench.cycle().outputs == Outputs(clamp=True)  # there is no changer for blocks
    bench.robot.plant.trip(1)
    assert bench.robot.advance() is None
