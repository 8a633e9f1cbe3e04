"""Half waves that go on by themselves are told from what reference, disturbance, noise and damped modes make."""

import numpy as np
import pytest

from stagectl.robot.midranging.axis_record import OSCILLATING, SWING
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.oscillation_kernel import MOST, is_oscillating
from tests.stagectl.robot.midranging.test_dead_time import FAST, RATE, Pair, _axis, _steps

TIME = np.arange(2500) / RATE
SINE = 0.4e-3 * np.sin(2.0 * np.pi * 20.0 * TIME)


def begun_at(error: np.ndarray, called: np.ndarray | float = 0.0) -> float | None:
    """When an oscillation is seen, s."""
    swing = np.zeros(1, SWING)[0]
    swing["pole"], swing["least"], swing["noise"] = 0.99, 0.1e-3, 10e-6
    for n, (each, asked) in enumerate(zip(error, np.broadcast_to(called, error.shape), strict=True)):
        if is_oscillating(swing, float(each), float(asked)):
            return n / RATE
    return None


@pytest.mark.parametrize("offset", [0.0, 5e-3])
def test_an_oscillation_is_seen_after_its_half_waves_whatever_it_is_about(offset: float) -> None:
    found = begun_at(SINE + offset)
    assert found is not None
    assert MOST / 40.0 <= found < MOST / 40.0 + 2.5  # the mean has to arrive, at 0.4 s


def test_it_is_seen_between_steps_of_the_reference() -> None:
    steps = np.where(TIME % 2.0 < 1.0, 2e-3, -2e-3)
    assert begun_at(SINE + np.sign(steps) * 2e-3 * np.exp(-(TIME % 1.0) / 0.05), steps) is not None


@pytest.mark.parametrize("damping", [0.02, 0.05])
def test_a_mode_that_rings_after_every_step_is_none(damping: float) -> None:
    since = TIME % 2.0
    ringing = 2e-3 * np.exp(-damping * 2.0 * np.pi * 20.0 * since) * np.sin(2.0 * np.pi * 20.0 * since)
    assert begun_at(ringing, np.where(TIME % 4.0 < 2.0, 2e-3, -2e-3)) is None


def test_what_is_called_for_from_outside_noise_and_what_is_small_are_none() -> None:
    assert begun_at(SINE, -3.0 * SINE) is None
    assert begun_at(0.2 * SINE) is None
    assert begun_at(0.3e-3 * np.random.default_rng(1).standard_normal(2500)) is None
    assert begun_at(np.zeros(2500)) is None


@pytest.mark.parametrize(("swing", "is_seen"), [(20e-6, True), (1e-6, False)])
def test_an_oscillation_that_only_noise_is_smaller_than_makes_control_cautious_and_takes_nothing_over(
    swing: float, is_seen: bool
) -> None:
    """It is 0.4 % of the travel; the one that is not seen is smaller than what noise of 1 um explains."""
    held = np.concatenate((_steps()[:1500], np.full(2000, _steps()[1500])))
    got = Pair(swings=("relative", "fast"), swing=swing).run(_axis(), held)
    assert (got["active"][2000:] == 1.0).all()
    assert got["cautious"] == is_seen
    slow_pole = np.exp(-1.0 / (0.5 * FAST.time_constant(RATE) * RATE))
    assert (got["pole"] == pytest.approx(slow_pole)) == is_seen


@pytest.mark.parametrize("frequency", [1.0, 5.0, 20.0])
def test_a_disturbance_that_swings_and_noise_make_nothing_cautious(frequency: float) -> None:
    learning = {f"{name}_learning": LeastSquares(noise=20e-6, smoothing=time, gate=3.0)
                for name, time in (("fast", 0.1), ("slow", 0.5))}  # fmt: skip
    pair = Pair(swings=("relative",), swing=0.6e-3, noise=20e-6, frequency=frequency)
    assert not pair.run(_axis(**learning), _steps())["cautious"]


@pytest.mark.parametrize(("swings", "phase"), [(("relative", "fast"), 2.0), (("relative",), 1.0)])
def test_valve_position_control_takes_over_where_the_micro_manipulator_swings_by_itself(
    swings: tuple[str, ...], phase: float
) -> None:
    """The same as a disturbance from outside is none of the loop's."""
    got = Pair(swings=swings).run(_axis(), _steps())
    assert got["active"][-1] == phase
    if phase == 2.0:
        begins = int(np.flatnonzero(got["active"] == 2.0)[0])
        assert got["reason"] == OSCILLATING
        assert got["cautious"]
        assert abs(got["slow_reference"][begins] - got["slow_reference"][begins - 1]) < 0.5e-3


def test_the_gain_of_valve_position_control_is_halved_three_times_where_that_oscillates_too() -> None:
    axis = _axis()
    got = Pair(swings=("relative", "fast")).run(axis, np.concatenate((_steps(), np.zeros(1000))))
    assert got["gain"] == axis.valve.fast.gain / 8.0
