"""The truth about a nonlinear simulated vibrator at work: its linearisation around a drive, without noise and drift."""

import numpy as np

from firmware_sim.plants.vibrator import VibratorPlant
from tests.calibration.linear_vibrator import RATE

PERIOD = round(5 * RATE)
"""Samples: lines are 0.2 Hz apart."""
QUIET = {"noise": -400.0, "hum": -400.0, "drift": 0.0}
PERTURBATION = 0.01
"""V rms, in all lines together: 30 dB and more under the drives."""
RECORDS = 128
REACH, DEGREE = 4, 2
"""Lines to each side of a local polynomial: it halves what is left of the perturbation's own beat with the drive."""


def linearised(seed: int, drive: np.ndarray, first: int, last: int, rounds: int, records: int = RECORDS) -> np.ndarray:
    """Return the mean linear response (lines, 2, 2), m/s^2 per V, at bins `first` to `last` of the drive's window.

    Finite differences: the drive is repeated with small multisines added, which only their phases tell apart, and the
    difference to the response without them is read line by line.

    Parameters
    ----------
    seed : int
    drive : array, shape (lead + PERIOD + tail, 2), V
        The window is what `window_of` returns.
    first, last, rounds, records : int
        Repetitions are rounds, with new phases, times records; the error falls with their root.
    """
    plant = VibratorPlant(RATE, seed=seed, **QUIET)
    bins = np.arange(first - 50, last + 51)
    code = 1 + 2 * (np.arange(len(bins)) % ((records - 1) // 2))[:, None] + np.arange(2)
    rest, answer = np.zeros(drive.shape), np.zeros(drive.shape)
    for _ in range(2):
        plant.run(drive, rest)
    amplitude, window = PERTURBATION * np.sqrt(2 / len(bins)), window_of(drive)
    rng, total = np.random.default_rng(7), np.zeros((last - first + 1, 2, 2), complex)
    for _ in range(rounds):
        phase = 2j * np.pi * rng.random((len(bins), 2))
        for record in range(records):
            spectrum = np.zeros((PERIOD // 2 + 1, 2), complex)
            lines = amplitude * np.exp(phase + 2j * np.pi * code * record / records)
            spectrum[bins] = PERIOD / 2 * lines
            perturbed = drive.copy()
            perturbed[window] += np.fft.irfft(spectrum, PERIOD, axis=0)
            plant.run(perturbed, answer)
            heard = np.fft.rfft((answer - rest)[window], axis=0)[first : last + 1] * (2 / PERIOD)
            total += heard[:, :, None] / lines[50:-50, None, :]
    return _smooth(total / (rounds * records))


def window_of(drive: np.ndarray) -> slice:
    """Return the PERIOD samples in which a drive is looked at: behind 0.2 s for a shot, else at the end."""
    lead = round(0.2 * RATE) if len(drive) == PERIOD + round(0.6 * RATE) else len(drive) - PERIOD
    return slice(lead, lead + PERIOD)


def _smooth(response: np.ndarray) -> np.ndarray:
    count = 2 * REACH + 1
    basis = np.vander(np.arange(-REACH, REACH + 1) / REACH, DEGREE + 1)
    project = basis @ np.linalg.pinv(basis)
    first = np.clip(np.arange(len(response)) - REACH, 0, len(response) - count)
    window = first[:, None] + np.arange(count)
    smooth: np.ndarray = np.einsum("lw,lw...->l...", project[np.arange(len(response)) - first], response[window])
    return smooth
