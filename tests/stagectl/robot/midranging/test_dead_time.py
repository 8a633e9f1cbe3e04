"""Adaptive internal model control of a macro manipulator with a dead time: found, bounded, and given up in time."""

from collections import deque
from dataclasses import dataclass

import numpy as np
import pytest

from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel, InternalModelAxis
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel

RATE = 250.0
FAST, SLOW = LoopModel((0.96,), (0.04,)), LoopModel.first_order(0.5, RATE)
LIMIT, GAIN = 10e-3, 5.0


@dataclass
class Pair:
    """A micro manipulator of first order, and a macro one behind a dead time, whose gain may change or which sticks."""

    delay: int = 8
    noise: float = 0.0
    slow_gain: float = 1.0
    changed_at: int = 10**9
    stuck: range = range(0)
    dark: str = ""
    swings: tuple[str, ...] = ()
    swing: float = 0.6e-3
    frequency: float = 20.0

    def run(self, axis: InternalModelAxis, reference: np.ndarray) -> dict[str, np.ndarray]:
        """Return what the axis made of it, and the control signal itself, shape (samples,) each."""
        block, random, fast, slow = InternalModel([axis]), np.random.default_rng(1), 0.0, 0.0
        block.prepare(RATE, 1)
        line, outputs = (
            deque([0.0] * (self.delay + 1)),
            {port.name: np.zeros((1, port.width)) for port in block.outputs},
        )
        kept: list[list[float]] = []
        for n, value in enumerate(reference):
            shown = {"reference": value, "relative": fast + slow, "fast": fast, "slow": slow}
            noisy = {name: each + self.noise * random.standard_normal() for name, each in shown.items()}
            noisy["reference"] = value
            for name in self.swings if n >= 2000 else ():
                noisy[name] += self.swing * np.sin(2.0 * np.pi * self.frequency * n / RATE)
            if self.dark and 1500 <= n < 1800:
                noisy[self.dark] = np.nan
            block.process(*(np.array([[each]]) for each in noisy.values()), *outputs.values())
            given, wanted = outputs["fast_reference"][0, 0], outputs["slow_reference"][0, 0]
            kept.append([fast + slow, GAIN * (given - fast), given, wanted, outputs["active"][0, 0]])
            line.append(wanted)
            if n not in self.stuck:
                fast += 0.04 / GAIN * float(np.clip(GAIN * (given - fast), -LIMIT, LIMIT))
            gain = self.slow_gain if n >= self.changed_at else 1.0
            slow += SLOW.inputs[0] * (gain * line.popleft() - slow)
        named = zip(
            ("relative", "control", "fast_reference", "slow_reference", "active"), np.array(kept).T, strict=True
        )
        record = block._records  # noqa: SLF001 (what has been found)
        return dict(named) | {
            "delay": record["slow"]["delay"],
            "reason": record["reason"],
            "gain": record["valve"]["fast_gain"],
            "cautious": bool(record["cautious"].all()),
            "pole": record["fast"]["filter_pole"],
        }


def _axis(**more: object) -> InternalModelAxis:
    wanted = LoopModel.first_order(FAST.time_constant(RATE), RATE)
    learning = {f"{name}_learning": LeastSquares(noise=1e-6, smoothing=time, gate=3.0)
                for name, time in (("fast", 0.1), ("slow", 0.5))}  # fmt: skip
    settings: dict[str, object] = {
        "governor": Governor((GAIN,), limit=LIMIT, travel=5e-3),
        "estimation": Estimation(4.0, half_periods=4.0),
        **learning,
    }
    return InternalModelAxis(FAST, SLOW, wanted, SLOW, **{**settings, **more})  # type: ignore[arg-type]


def _steps(size: float = 4e-3) -> np.ndarray:
    wave = np.where(np.arange(4000) // 500 % 2, 0.0, size)
    return np.concatenate((np.zeros(1250), wave))


@pytest.mark.parametrize("delay", [0, 3, 10])
def test_the_dead_time_is_found_in_the_estimation_phase(delay: int) -> None:
    got = Pair(delay).run(_axis(), _steps())
    assert got["delay"] == pytest.approx(delay, abs=2)
    assert (got["active"][1100:] == 1.0).all()


def test_a_dead_time_that_is_told_is_used_where_none_is_to_be_tried() -> None:
    axis = _axis(slow_delay=0.02, estimation=Estimation(1.0, half_periods=2.0, latest=0.0))
    assert Pair(5).run(axis, np.zeros(600))["delay"] == 5


@pytest.mark.parametrize("noise", [0.0, 50e-6])
@pytest.mark.parametrize("dark", ["", "fast", "slow", "relative"])
def test_the_control_signal_keeps_its_limit_with_noise_and_without_a_sensor(noise: float, dark: str) -> None:
    learning = {f"{name}_learning": LeastSquares(noise=max(noise, 1e-6), smoothing=time, gate=3.0)
                for name, time in (("fast", 0.1), ("slow", 0.5))}  # fmt: skip
    got = Pair(noise=noise, dark=dark).run(_axis(**learning), _steps())
    assert abs(got["control"]).max() <= LIMIT * (1.0 + 1e-9)
    assert abs(got["relative"][-1]) < 0.2e-3


def test_the_slow_reference_stays_within_the_travel_of_the_whole() -> None:
    got = Pair().run(_axis(), _steps())
    assert (got["slow_reference"] >= -5e-3 - 1e-9).all()
    assert (got["slow_reference"] <= 4e-3 + 5e-3 + 1e-9).all()


def test_where_the_slow_loop_is_another_by_far_valve_position_control_takes_over_and_nothing_jumps() -> None:
    """Its gain turns to minus 1.5 times its own: no controller of the pair can go on, and none may run away."""
    got = Pair(slow_gain=-1.5, changed_at=2250).run(_axis(), _steps())
    begins = int(np.flatnonzero(got["active"] == 2.0)[0])
    assert 2250 < begins < 4000
    for name, most in (("fast_reference", 0.5e-3), ("slow_reference", 0.5e-3)):
        assert abs(got[name][begins] - got[name][begins - 1]) < most
    assert abs(got["slow_reference"]).max() < 20e-3
    assert abs(got["control"]).max() <= LIMIT * (1.0 + 1e-9)


def test_while_the_micro_manipulator_sticks_the_macro_one_does_its_work() -> None:
    reference = np.concatenate((np.zeros(1250), np.full(4000, 4e-3)))
    got = Pair(stuck=range(1250, 3500)).run(_axis(), reference)
    assert got["relative"][3400] == pytest.approx(4e-3, abs=0.4e-3)
    assert got["relative"][-1] == pytest.approx(4e-3, abs=0.1e-3)
    assert abs(got["slow_reference"]).max() <= 9e-3 + 1e-6


@pytest.mark.parametrize("name", ["fast_delay", "slow_delay"])
def test_a_dead_time_beyond_its_range_is_refused_by_name(name: str) -> None:
    with pytest.raises(ValueError, match=rf"{name} is 1\.5 s, must be 0 to 1\.0"):
        _axis(**{name: 1.5})


def test_a_share_of_dead_times_beyond_its_range_is_refused() -> None:
    with pytest.raises(ValueError, match=r"latest is 1\.5, must be 0 to 1"):
        Estimation(latest=1.5)
