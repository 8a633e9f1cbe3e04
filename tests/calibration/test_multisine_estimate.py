from collections.abc import Callable

import numpy as np
import pytest

from calibration.multisine import Design
from calibration.multisine_estimate import Spectra, coherence_of, levels, matrix_on, raw_matrix, spectra_of
from calibration.vibrator_multisine import flat_design
from rigkit import config as rig_file
from tests.calibration.linear_vibrator import LINEAR, emitter, linear_response
from tests.calibration.test_multisine import PERIOD, design
from vibractl.config import RigConfig

Machine = Callable[[np.ndarray], np.ndarray]


def measured(made: Design, machine: Machine, noise: float = 0.0) -> Spectra:
    rng = np.random.default_rng(5)
    drives = [np.zeros_like(made.one_period(0)), *(made.one_period(number) for number in range(made.records))]
    heard = [machine(drive) for drive in drives]
    periods = ((u, y + noise * rng.standard_normal(y.shape)) for u, y in zip(drives, heard, strict=True))
    return spectra_of(made, periods, int(made.bins[0]), int(made.bins[-1]))


def mixed(matrix: np.ndarray) -> Machine:
    return lambda drive: np.asarray(drive @ matrix.T)


@pytest.mark.parametrize(("inputs", "outputs", "records"), [(1, 1, 2), (2, 3, 8), (4, 4, 5)])
def test_any_number_of_inputs_and_outputs_is_told_apart(inputs: int, outputs: int, records: int) -> None:
    matrix, made = np.random.default_rng(6).standard_normal((outputs, inputs)), design(inputs, records)
    found, variance = matrix_on(made, raw_matrix(made, measured(made, mixed(matrix))), np.arange(60, 700))
    assert np.allclose(found, matrix, atol=1e-9)
    assert np.sqrt(variance).max() < 0.02 * np.abs(matrix).max()


def test_even_and_odd_distortion_and_noise_are_told_apart() -> None:
    made = design(1)
    detection = np.setdiff1d(np.arange(made.bins[0], made.bins[-1] + 1, 2), made.bins)
    linear, square, cube = (
        levels(made, measured(made, machine, 1e-6), detection)
        for machine in (lambda x: x, lambda x: x + 0.3 * x**2, lambda x: x + 0.3 * x**3)
    )
    inside = (linear.frequency > 20) & (linear.frequency < 180)
    for quiet in (linear.even, linear.odd, square.odd, cube.even):
        assert quiet[inside].max() < 5 * linear.noise[inside].mean()
    for loud in (square.even, cube.odd):
        assert loud[inside].mean() > 20 * linear.noise[inside].mean()
    assert linear.noise[inside].mean() == pytest.approx(1e-6 * 2 / np.sqrt(PERIOD), rel=0.1)
    assert linear.response[inside].mean() == pytest.approx(0.01 * np.sqrt(8 / 7), rel=0.02)


@pytest.mark.parametrize("width", [4.0, 8.0, 16.0])
def test_narrow_resonances_are_found_within_the_stated_variance(width: float) -> None:
    """Half-widths of 2, 4 and 8 excited lines; a wide polynomial alone misses the narrowest by half its height."""
    made, rng, wanted = design(1), np.random.default_rng(8), np.arange(360, 441)

    def resonance(bins: np.ndarray) -> np.ndarray:
        return np.asarray(1 / (1 + 1j * (bins - 400) / width))

    noise = 0.01 * rng.standard_normal((len(made.bins), 2)) @ np.array([1, 1j])
    found, variance = matrix_on(made, (resonance(made.bins) + noise)[:, None, None], wanted)
    missed = np.abs(found[:, 0, 0] - resonance(wanted))
    assert missed.max() < 0.2
    assert np.percentile(missed**2 / variance[:, 0, 0], 95) < 3.5


def test_a_linear_vibrator_is_found_within_the_stated_variance() -> None:
    made, _ = flat_design(rig_file.load(None, RigConfig, ["characterisation.records=4"]))
    play = emitter(1, noise=-20.0, **LINEAR)
    still = np.zeros((made.period, 2))
    periods = [(still, still)]
    for number in range(made.records):
        period = made.one_period(number)
        drive, response = play(np.concatenate([period[-44_100:], period]))
        periods.append((drive[44_100:].astype(float), response[44_100:].astype(float)))
    spectra = spectra_of(made, periods, int(made.bins[0]), int(made.bins[-1]))
    bins = np.arange(80, 3200, 20)
    found, variance = matrix_on(made, raw_matrix(made, spectra), bins)
    ratio = np.abs(found - linear_response(1, bins * 0.2)) ** 2 / variance
    assert 0.2 < np.median(ratio) < 0.8
    assert np.percentile(ratio, 95) < 4


def test_coherence_is_the_part_of_the_power_that_is_response() -> None:
    assert coherence_of(np.array([3j]), np.array([1.0])).tolist() == [0.9]


def test_a_missing_record_is_refused() -> None:
    made = design()
    with pytest.raises(ValueError, match="1 records, must be 8"):
        spectra_of(made, [(made.one_period(0), made.one_period(0))] * 2, 1, 500)
