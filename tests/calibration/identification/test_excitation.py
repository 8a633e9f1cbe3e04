"""Inputs that go together: refused where everywhere, named by band where nearly, passed in silence where not."""

import numpy as np
import pytest
from scipy.signal import butter, chirp, sosfilt

from calibration.identification.excitation import excitation_notes, nearly_collinear
from calibration.subspace import identify
from tests.calibration.identification.plain_scipy import RATE, off, response, white

NAMES = ("u1", "u2")
SEEDS = range(5)


def alike(seed: int, own: float, samples: int = 4_000) -> np.ndarray:
    """Return u1 and u2 = 1.2 u1 with noise of its own, a part of its rms."""
    drive = white(seed, samples)
    return np.column_stack([drive[:, 0], 1.2 * (drive[:, 0] + own * drive[:, 1])])


@pytest.mark.parametrize("seed", SEEDS)
def test_one_input_that_is_another_ones_multiple_is_refused(seed: int) -> None:
    complaint = r"inputs u1 and u2 are not distinguishable: .* must have >= 1e-06: drive them by independent signals"
    with pytest.raises(ValueError, match=complaint):
        nearly_collinear([alike(seed, 0.0)], RATE, NAMES)


@pytest.mark.parametrize("bits", [16, 24])
def test_a_multiple_that_a_recorder_has_rounded_is_refused(bits: int) -> None:
    rounded = np.round(0.1 * alike(0, 0.0) * 2.0 ** (bits - 1)) / 2.0 ** (bits - 1)
    with pytest.raises(ValueError, match="are not distinguishable"):
        nearly_collinear([rounded], RATE, NAMES)


@pytest.mark.parametrize("seed", SEEDS)
def test_one_percent_of_independent_noise_is_warned_of_with_its_band(seed: int) -> None:
    (found,) = nearly_collinear([alike(seed, 0.01)], RATE, NAMES)
    assert (found.inputs, found.high) == (NAMES, 500.0)
    assert found.low < 5
    assert 1e-6 < found.share < 1e-4
    (note,) = excitation_notes([found])
    assert "inputs nearly go together at 3.906 to 500 Hz (u1 and u2" in note


@pytest.mark.slow
def test_the_factor_that_is_told_is_that_of_the_errors() -> None:
    ratios, told = [], []
    frequency = np.linspace(10, 200, 100)
    for seed in range(3):
        errors = []
        for drive in (alike(seed, 0.01), white(seed, 4_000)):
            model = identify(drive, response(drive, seed=seed), RATE, order=8, horizon=20).model
            errors.append(off(model.frequency_response(frequency), frequency))
        ratios.append(errors[0] / errors[1])
        (found,) = nearly_collinear([alike(seed, 0.01)], RATE, NAMES)
        told.append(0.5 / np.sqrt(found.share))
    assert 0.4 < np.median(ratios) / np.median(told) < 2


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("samples", [300, 4_000])
def test_independent_inputs_are_passed_in_silence(seed: int, samples: int) -> None:
    assert nearly_collinear([white(seed, samples)], RATE, NAMES) == ()
    assert excitation_notes(()) == []


def test_only_the_band_in_which_they_go_together_is_named() -> None:
    common, own = white(1, 20_000), white(2, 20_000)
    low, high = (butter(8, 150, kind, fs=RATE, output="sos") for kind in ("low", "high"))
    drive = sosfilt(low, common[:, [0, 0]], axis=0) + sosfilt(high, own, axis=0)
    (found,) = nearly_collinear([drive], RATE, NAMES)
    assert found.low < 5
    assert 95 < found.high < 120


def test_the_two_of_three_that_go_together_are_named() -> None:
    pair = alike(3, 0.005)
    drive = np.column_stack([pair[:, 0], white(4, 4_000)[:, 0], pair[:, 1]])
    assert {found.inputs for found in nearly_collinear([drive], RATE, ("u1", "u2", "u3"))} == {("u1", "u3")}


def test_inputs_driven_one_after_the_other_or_in_recordings_of_their_own_are_apart() -> None:
    sweep = chirp(np.arange(4_000) / RATE, 5.0, 4.0, 200.0)[:, None]
    first, second = sweep * [1.0, 0.0], sweep * [0.0, 1.2]
    assert nearly_collinear([first, second], RATE, NAMES) == ()
    assert nearly_collinear([np.concatenate([first, second])], RATE, NAMES) == ()
    with pytest.raises(ValueError, match="are not distinguishable"):
        nearly_collinear([first + second], RATE, NAMES)


def test_a_single_input_is_not_looked_at() -> None:
    assert nearly_collinear([white(0, 1_000)[:, :1]], RATE, ("u",)) == ()
