"""What hydrophones hear of the accelerometers is found with its delay, within its variance."""

from pathlib import Path

import numpy as np
import pytest

from calibration.experiment import RawFolder
from calibration.far_field_estimate import FarFieldError, travel_time
from calibration.vibrator import calibrate
from firmware_sim.plants.vibrator_array import VibratorArrayPlant
from tests.calibration.far_field_rig import RATE, SHORT, array_config, array_emitter, true_transfer
from tests.calibration.linear_vibrator import ABOUT
from vibractl.far_field import FarField

WATER = {"vibrators": 1, "medium": "water"}


def measured(folder: Path, plant: VibratorArrayPlant, *settings: str) -> FarField:
    config = array_config(plant.vibrators, plant.hydrophones, *settings)
    with RawFolder(folder) as raw:
        found = calibrate(config, raw, array_emitter(plant), ABOUT)
    assert found.matrix.response.shape[1:] == (2 * plant.vibrators, 2 * plant.vibrators)
    assert found.far is not None
    return found.far


def deviations(far: FarField, plant: VibratorArrayPlant) -> tuple[np.ndarray, np.ndarray]:
    """Return errors relative to |T| and squared errors over their variance."""
    truth = true_transfer(plant, far.prompt.frequency)
    error = np.abs(far.response - truth)
    return error / np.abs(truth), error**2 / far.prompt.variance


@pytest.mark.slow
def test_a_vibrators_far_field_is_found_to_a_few_parts_in_a_thousand(tmp_path: Path) -> None:
    plant = VibratorArrayPlant(RATE, hydrophones=2, **WATER)
    far = measured(tmp_path, plant)
    relative, normalised = deviations(far, plant)
    assert np.percentile(relative, 95) < 0.004
    assert np.percentile(normalised, 95) < 3.0
    np.testing.assert_allclose(far.delay, 10.0 / 1500.0, atol=0.001)


def test_what_a_noisy_hydrophone_leaves_open_is_in_the_variance(tmp_path: Path) -> None:
    plant = VibratorArrayPlant(RATE, far_field_noise=-40.0, **WATER)
    relative, normalised = deviations(measured(tmp_path, plant, *SHORT), plant)
    assert np.median(relative) > 0.005
    assert 0.5 < normalised.mean() < 1.8


def test_two_vibrators_are_told_apart_by_one_hydrophone(tmp_path: Path) -> None:
    plant = VibratorArrayPlant(RATE, medium="water", noise=-100.0, far_field_noise=-100.0)
    relative, _ = deviations(measured(tmp_path, plant, "band=[100, 160]", "records=6", "period=2"), plant)
    assert np.percentile(relative, 95) < 0.02


@pytest.mark.slow
def test_a_stepped_sine_finds_it_as_well(tmp_path: Path) -> None:
    plant = VibratorArrayPlant(RATE, **WATER)
    settings = ("method=stepped", "passes=1", "band=[100, 130]", "tone=0.2", "step=1")
    relative, _ = deviations(measured(tmp_path, plant, *settings), plant)
    assert np.percentile(relative, 95) < 0.02


def test_a_delay_of_a_third_of_a_second_is_told_from_the_phases_alone() -> None:
    frequency, rng = np.arange(20.0, 120.0, 0.4), np.random.default_rng(1)
    response = rng.standard_normal((len(frequency), 2, 2)) + 1j * rng.standard_normal((len(frequency), 2, 2))
    pressure = response.sum(axis=1, keepdims=True) * np.exp(-2j * np.pi * 0.3337 * frequency)[:, None, None]
    assert travel_time(frequency, response, pressure)[0] == pytest.approx(0.3337, abs=0.0026)


def test_a_hydrophone_farther_away_than_the_run_in_is_refused(tmp_path: Path) -> None:
    plant = VibratorArrayPlant(RATE, distance=150.0, vibrators=1)  # in air, 0.44 s
    said = r"hydrophone 1, input 4: hears the vibrator 0.43\d s late, must be <= characterisation.run_in, 0.3 s"
    with pytest.raises(FarFieldError, match=said):
        measured(tmp_path, plant, *SHORT)


def test_a_hydrophone_that_hears_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FarFieldError, match=r"coherence with the accelerometers is 0\.\d+, must be >= 0.8"):
        measured(tmp_path, VibratorArrayPlant(RATE, far_field_noise=0.0, **WATER), *SHORT)


def test_a_hydrophone_that_is_not_plugged_in_is_refused(tmp_path: Path) -> None:
    plant = VibratorArrayPlant(RATE, **WATER)
    emit = array_emitter(plant)
    config = array_config(1, 1, *SHORT)
    with RawFolder(tmp_path) as raw, pytest.raises(FarFieldError, match="hydrophone 1, input 4: silent"):
        calibrate(config, raw, lambda drive: (emit(drive)[0], emit(drive)[1] * np.float32([1, 1, 0])), ABOUT)
