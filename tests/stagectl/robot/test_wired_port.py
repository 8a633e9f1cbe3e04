"""The port within a graph judges as the one over UDP does."""

from typing import Any

import numpy as np
import pytest

from stagectl.robot.config import CellConfig, Robot
from stagectl.robot.wired_port import WiredPort

HOME = np.array([0.0, 0.0, 0.0, 0.0, 0.5, 0.0])


class Bench:
    def __init__(self) -> None:
        self.told: list[tuple[str, Any]] = []
        self.port = WiredPort(CellConfig(robot=Robot()), HOME, lambda event, fields: self.told.append((event, fields)))
        self.port.prepare(250.0, 1)
        self.report, self.reference = 0, np.empty((1, 6))

    def cycle(self, correction: float = 0.0, motors: float = 1.0, is_mute: bool = False) -> float:
        self.report += not is_mute
        holding = np.empty((1, 1))
        offset = np.zeros((1, 6))
        offset[0, 0] = correction
        flags = np.full((1, 1), float(self.report)), np.full((1, 1), motors)
        self.port.process(*flags, HOME[None], HOME[None], HOME[None], offset, self.reference, holding)
        return float(holding[0, 0])


def test_it_cannot_start_before_the_robot_is_heard() -> None:
    bench = Bench()
    with pytest.raises(ValueError, match="the robot cannot start: it is silent"):
        bench.port.start()


def test_it_holds_until_it_is_started_and_then_lets_references_through() -> None:
    bench = Bench()
    assert bench.cycle(1e-4) == 1.0
    np.testing.assert_array_equal(bench.reference[0], HOME)
    bench.port.start()
    assert bench.cycle(1e-4) == 0.0
    assert bench.reference[0, 0] == pytest.approx(1e-4)


def test_a_correction_beyond_a_millimetre_is_held_and_told() -> None:
    bench = Bench()
    bench.cycle()
    bench.port.start()
    for n in range(1, 20):
        bench.cycle(2e-4 * n)
    assert bench.port.reason.startswith("the correction moves the tool by 1.")
    assert [event for event, _ in bench.told] == ["robot_fault"]
    assert bench.reference[0, 0] < 2.6e-3


def test_silence_and_motors_off_are_named() -> None:
    for quiet, reason in (({"is_mute": True}, "silent for"), ({"motors": 0.0}, "motors are off")):
        bench = Bench()
        bench.cycle()
        bench.port.start()
        bench.cycle()
        assert [bench.cycle(**quiet) for _ in range(5)][-1] == 1.0  # type: ignore[arg-type]
        assert reason in bench.port.reason
        with pytest.raises(ValueError, match="the robot cannot start"):
            bench.port.start()
