"""The sensor check holds off what cannot be, and latches what lasts."""

import numpy as np
import pytest

from stagectl.config import Sensors
from stagectl.stage.sensors import SensorCheck

RATE = 10_000.0
SENSORS = Sensors(tolerated=2, stuck=0.01)


def run(check: SensorCheck, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Show axis 2 these positions, all else in order; return what was let in, and the faults."""
    random = np.random.default_rng(4)
    frames = len(position)
    shown = 200e-6 + 1e-9 * random.standard_normal((frames, 3))
    shown[:, 1] = position
    extension = 40e-6 + 1e-9 * random.standard_normal((frames, 3))
    valid, stretched, fault = np.empty((frames, 3)), np.empty((frames, 3)), np.empty((frames, 1))
    check.process(shown, extension, valid, stretched, fault)
    np.testing.assert_array_equal(stretched, extension)
    return valid[:, 1], fault[:, 0]


def positions(frames: int = 200) -> np.ndarray:
    return 200e-6 + 1e-9 * np.random.default_rng(9).standard_normal(frames)


def prepared() -> SensorCheck:
    check = SensorCheck(SENSORS, 3)
    check.prepare(RATE, 200)
    return check


def test_good_samples_pass_bit_for_bit() -> None:
    shown = positions()
    valid, fault = run(prepared(), shown)
    np.testing.assert_array_equal(valid, shown)
    assert not fault.any()


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 700e-6, 200e-6 + 1e-3, -1.0])
def test_as_many_wrong_samples_as_tolerated_are_held_off(wrong: float) -> None:
    check, shown = prepared(), positions()
    shown[50:52] = wrong
    valid, fault = run(check, shown)
    np.testing.assert_array_equal(valid[50:52], shown[49])
    np.testing.assert_array_equal(valid[52:], shown[52:])
    assert not fault.any()
    assert check.held == 2


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (np.nan, "position 2 is not a number at sample 52: nan m"),
        (700e-6, "position 2 is out of its range at sample 52: 0.0007 m, must be -1e-05 to 0.00052 m"),
        (450e-6, "position 2 jumps at sample 52: 0.00045 m, must be 0.000124"),
    ],
)
def test_one_more_than_tolerated_latches_and_says_what_was_wrong(wrong: float, text: str) -> None:
    check, shown = prepared(), positions()
    shown[50:53] = wrong
    valid, fault = run(check, shown)
    assert np.flatnonzero(fault)[0] == 52
    assert fault[-1] != 0, "a latch stays although the sensor is right again"
    assert np.isfinite(valid).all()
    assert str(check.fault).startswith(text)


def test_a_sensor_that_repeats_itself_is_stuck() -> None:
    check, shown = prepared(), positions()
    shown[20:] = shown[20]
    _, fault = run(check, shown)
    assert np.flatnonzero(fault)[0] == 120
    assert "position 2 is stuck" in str(check.fault)
    assert "for 100 samples" in str(check.fault)


def test_a_stage_that_moves_as_fast_as_it_can_is_no_jump() -> None:
    shown = 200e-6 + 0.24 / RATE * np.arange(3)
    _, fault = run(prepared(), np.concatenate([np.full(50, 200e-6) + positions(50) * 1e-3, shown]))
    assert not fault.any()


def test_wrong_from_the_first_sample_on_is_a_fault_and_no_nan_gets_in() -> None:
    check = prepared()
    valid, fault = run(check, np.full(200, np.nan))
    assert np.isfinite(valid).all()
    assert fault[-1] != 0


def test_a_fault_that_is_still_there_latches_again_after_it_is_cleared() -> None:
    check = prepared()
    run(check, np.full(200, np.nan))
    check.clear()
    assert check.fault is None
    run(check, np.full(200, np.nan))
    assert check.fault is not None


def test_a_latch_survives_prepare() -> None:
    check = prepared()
    run(check, np.full(200, np.nan))
    check.prepare(RATE, 200)
    assert check.fault is not None
