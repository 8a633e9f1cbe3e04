"""Valve position control on its own, against its equations."""

import math

import numpy as np
import pytest

from stagectl.robot.midranging.tuning import Pi, integral, lambda_tuned
from stagectl.robot.midranging.valve_position import ValvePosition, ValvePositionAxis

RATE = 250.0


def _run(axes: list[ValvePositionAxis], *signals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    block = ValvePosition(axes)
    block.prepare(RATE, len(signals[0]))
    fast, slow = (np.full((len(signals[0]), len(axes)), np.nan) for _ in range(2))
    block.process(*signals, fast, slow)
    return fast, slow


def _noise(axes: int) -> list[np.ndarray]:
    return list(np.random.default_rng(2).standard_normal((3, 200, axes)) * 1e-3)


def test_the_controllers_are_those_of_figure_2_12() -> None:
    reference, relative, control = _noise(1)
    fast, slow = _run([ValvePositionAxis(Pi(1.5, 10.0), Pi(0.8, 2.0), middle=0.25e-3)], reference, relative, control)
    error = (reference - relative)[:, 0]
    wanted = 1.5 * error + 10.0 / RATE * np.concatenate(([0.0], np.cumsum(error)[:-1]))
    np.testing.assert_allclose(fast[:, 0], wanted + 0.25e-3, rtol=1e-12)
    np.testing.assert_allclose(slow[:, 0], 0.8 * wanted + 2.0 / RATE * np.concatenate(([0.0], np.cumsum(wanted)[:-1])))


def test_anti_windup_tracks_what_the_saturation_lets_through() -> None:
    reference, relative, control = np.zeros((50, 1)), np.zeros((50, 1)), np.full((50, 1), 25e-3)
    axis = ValvePositionAxis(Pi(1.0, 10.0), Pi(1.0, 1.0), tracking=0.1, limit=10e-3, inner_gain=5.0)
    fast, _ = _run([axis], reference, relative, control)
    np.testing.assert_allclose(np.diff(fast[:, 0]), -(15e-3 / 5.0) / (0.1 * RATE), rtol=1e-12)


def test_without_anti_windup_the_control_signal_does_not_matter() -> None:
    reference, relative, control = _noise(1)
    axes = [ValvePositionAxis(Pi(1.0, 10.0), Pi(1.0, 1.0), limit=1e-4)]
    for one, other in zip(
        _run(axes, reference, relative, control), _run(axes, reference, relative, 0 * control), strict=True
    ):
        np.testing.assert_array_equal(one, other)


def test_axes_do_not_touch_each_other() -> None:
    signals = _noise(2)
    axes = [
        ValvePositionAxis(Pi(1.0, 10.0), Pi(1.0, 1.0), tracking=0.1, limit=1e-4),
        ValvePositionAxis(Pi(0.5, 3.0), integral(1.0), middle=1e-3, feed=1.0),
    ]
    both = _run(axes, *signals)
    for number, axis in enumerate(axes):
        alone = _run([axis], *(signal[:, [number]] for signal in signals))
        for one, other in zip(both, alone, strict=True):
            np.testing.assert_array_equal(one[:, [number]], other)


def test_feed_takes_what_the_slow_loop_does_off_the_fast_reference() -> None:
    error = np.zeros((1000, 1))
    error[0] = 1e-3
    axis = {"fast": lambda_tuned(0.1, 0.1), "slow": lambda_tuned(1.0, 1.0), "slow_time_constant": 1.0}
    fed, slow = _run([ValvePositionAxis(**axis, feed=1.0)], error, 0 * error, 0 * error)
    alone, _ = _run([ValvePositionAxis(**axis)], error, 0 * error, 0 * error)
    modelled, pole = np.zeros(1000), math.exp(-1.0 / RATE)
    for n in range(1, 1000):
        modelled[n] = pole * modelled[n - 1] + (1.0 - pole) * slow[n - 1, 0]
    np.testing.assert_allclose(fed[:, 0], alone[:, 0] - modelled, atol=1e-15)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"tracking": 0.0}, r"tracking is 0\.0 s, must be > 0"),
        ({"limit": math.nan}, r"limit is nan m/s, must be > 0"),
        ({"inner_gain": -1.0}, r"inner_gain is -1\.0 1/s, must be > 0"),
        ({"feed": 1.1}, r"feed is 1\.1, must be 0 to 1"),
        ({"middle": math.inf}, r"middle is inf m, must be finite"),
    ],
)
def test_a_wrong_setting_is_refused_by_name(wrong: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ValvePositionAxis(Pi(1.0, 1.0), Pi(1.0, 1.0), **wrong)


def test_no_axis_is_refused() -> None:
    with pytest.raises(ValueError, match="there are 0 axes"):
        ValvePosition([])


@pytest.mark.parametrize("port", [0, 1, 2])
def test_while_an_input_is_no_number_everything_stays(port: int) -> None:
    signals = _noise(1)
    axis = ValvePositionAxis(Pi(1.0, 10.0), Pi(1.0, 1.0), tracking=0.1, limit=1e-4)
    without = _run([axis], *(np.delete(signal, slice(50, 60), axis=0) for signal in signals))
    signals[port][50:60] = np.nan
    for one, other in zip(_run([axis], *signals), without, strict=True):
        np.testing.assert_array_equal(one[50:60], np.repeat(one[49:50], 10, axis=0))
        np.testing.assert_array_equal(np.delete(one, slice(50, 60), axis=0), other)
