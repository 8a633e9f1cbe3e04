"""Welch's spectra and the frequency response they give: levels, variance that covers, and several inputs at once."""

import numpy as np
import pytest

from calibration.welch import frequency_response, spectra
from tests.calibration.resonant_systems import RATE, order_7, order_18, sweep


def test_white_noise_has_its_variance_spread_evenly_to_half_the_rate() -> None:
    rng = np.random.default_rng(1)
    signal = 3.0 * rng.standard_normal((200_000, 1))
    found = spectra(signal, signal, RATE, 5.0)
    np.testing.assert_allclose(np.real(found.response[2:-2, 0, 0]), 9.0 / (RATE / 2), rtol=0.1)
    np.testing.assert_allclose(found.cross, found.drive)


def test_the_response_of_three_inputs_to_three_outputs_is_found() -> None:
    system = order_18()
    found = frequency_response(spectra(*system.record(400_000, seed=2), RATE, 0.1))
    band = (found.frequency > 5) & (found.frequency < 480)
    truth = system.model.frequency_response(found.frequency[band])
    missed = np.abs(found.response[band] - truth)
    assert found.response.shape == (len(found.frequency), 3, 3)
    assert np.median(missed / np.linalg.norm(truth, axis=(1, 2), keepdims=True)) < 0.05
    assert np.mean(missed**2 < 3 * found.variance[band]) == pytest.approx(0.95, abs=0.04)


def test_the_error_is_as_large_as_the_variance_says() -> None:
    """Of a static gain, so that no leakage counts; over bins, records and both overlapping and single segments."""
    rng = np.random.default_rng(3)
    gain = np.array([[2.0, -1.0]])
    ratios = []
    for _ in range(40):
        drive = rng.standard_normal((8000, 2)) @ np.array([[1.0, 0.6], [0.0, 0.5]])
        response = drive @ gain.T + 0.5 * rng.standard_normal((8000, 1))
        found = frequency_response(spectra(drive, response, RATE, 5.0))
        ratios.append(np.abs(found.response[3:-3] - gain) ** 2 / found.variance[3:-3])
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.12)


def test_coherence_is_the_part_explained() -> None:
    rng = np.random.default_rng(4)
    drive = rng.standard_normal((200_000, 1))
    response = np.concatenate([drive + rng.standard_normal((200_000, 1)), drive], axis=1)
    found = frequency_response(spectra(drive, response, RATE, 5.0))
    np.testing.assert_allclose(np.median(found.coherence[:, 0]), 0.5, atol=0.02)
    np.testing.assert_allclose(found.coherence[:, 1], 1.0)
    assert np.all(found.variance[:, 1] < 1e-12)


def test_inputs_driven_one_after_another_are_told_apart() -> None:
    system = order_18()
    records = []
    for channel in range(3):
        drive = np.zeros((60_000, 3))
        drive[:, channel] = sweep(60_000, 5.0, 300.0)[:, 0]
        records.append(system.record(60_000, seed=channel, drive=drive))
    found = frequency_response(spectra([each[0] for each in records], [each[1] for each in records], RATE, 0.2))
    band = (found.frequency > 20) & (found.frequency < 250)
    truth = system.model.frequency_response(found.frequency[band])
    assert np.median(np.abs(found.response[band] - truth) / np.linalg.norm(truth, axis=(1, 2), keepdims=True)) < 0.05


def test_an_input_that_is_not_driven_has_no_response_and_no_certainty() -> None:
    drive, response = order_7().record(20_000, seed=5)
    found = frequency_response(spectra(np.concatenate([drive, np.zeros_like(drive)], axis=1), response, RATE, 2.0))
    assert np.all(found.response[:, 0, 1] == 0)
    assert np.all(np.isinf(found.variance[:, 0, 1]))
    assert np.all(np.isfinite(found.variance[:, 0, 0]))


def test_what_records_do_not_allow_is_refused() -> None:
    drive, response = order_7().record(1000, seed=6)
    with pytest.raises(ValueError, match=r"resolution is 0\.5 Hz, must be 1 \(the shortest record\) to 125 Hz"):
        spectra(drive, response, RATE, 0.5)
    with pytest.raises(ValueError, match=r"means of 1\.0 segments, must be more than the 1 inputs"):
        frequency_response(spectra(drive, response, RATE, 1.0))
    with pytest.raises(ValueError, match=r"inputs have \[1000\] samples and outputs \[999\]"):
        spectra(drive, response[:-1], RATE, 5.0)
