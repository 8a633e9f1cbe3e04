"""What short sweeps on one coil at a time say: which accelerometer answers which coil, and with which sign."""

from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len
from scipy.optimize import linear_sum_assignment

from vibractl.decibels import FAINT, decibels

LOW_END = 1.6
"""Polarity is compared from the lowest frequency of the sweep to so many times that."""


def sweep(rate: float, band: tuple[float, float], seconds: float, amplitude: float) -> np.ndarray:
    """Make a linear sweep that begins and ends softly.

    Parameters
    ----------
    rate : float, samples/s
    band : (float, float), Hz
    seconds : float, s
    amplitude : float, V

    Returns
    -------
    array, shape (samples,), V
    """
    time = np.arange(round(seconds * rate)) / rate
    phase = 2 * np.pi * (band[0] * time + (band[1] - band[0]) / (2 * seconds) * time**2)
    edge = np.minimum(1.0, np.minimum(time, time[::-1]) / (0.1 * seconds))
    return np.asarray(amplitude * np.sin(phase) * np.sin(0.5 * np.pi * edge) ** 2)


@dataclass(frozen=True)
class Answers:
    """How the accelerometers answer each coil.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz
    response : complex array, shape (lines, responses, coils), m/s^2 per V
        With the delay of the round trip in it, the same in every element.
    loudness : array, shape (responses, coils), dB
        RMS response while a coil is driven, re silence.
    """

    frequency: np.ndarray
    response: np.ndarray
    loudness: np.ndarray


def answers(
    drive: np.ndarray, recorded: list[np.ndarray], silence: np.ndarray, rate: float, band: tuple[float, float]
) -> Answers:
    """Compare what came back with the drive, coil by coil.

    Parameters
    ----------
    drive : array, shape (samples,), V
        The same on each coil.
    recorded : list of arrays, each (more samples, responses), m/s^2
        One for each coil, from the drive's first sample on.
    silence : array, shape (at least as many samples, responses), m/s^2
    rate : float, samples/s
    band : (float, float), Hz, of the drive

    Returns
    -------
    Answers
    """
    samples = len(recorded[0])
    frames = next_fast_len(samples, real=True)
    frequency = np.fft.rfftfreq(frames, 1 / rate)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    sent = np.fft.rfft(drive, frames)[inside, None]
    heard = [np.fft.rfft(each, frames, axis=0)[inside] for each in recorded]
    quiet = np.fft.rfft(silence[:samples], frames, axis=0)[inside]
    floor = np.maximum(np.sqrt(np.mean(np.abs(quiet) ** 2, axis=0)), FAINT)
    loud = [np.sqrt(np.mean(np.abs(each) ** 2, axis=0)) / floor for each in heard]
    return Answers(
        frequency[inside],
        np.stack([each / sent for each in heard], axis=-1),
        decibels(np.maximum(np.stack(loud, axis=-1), FAINT)),
    )


def assignment(level: np.ndarray) -> tuple[list[int], float]:
    """Find which accelerometer belongs to each coil, and how clearly each is heard best on its own.

    Parameters
    ----------
    level : array, shape (responses, coils), dB

    Returns
    -------
    owner : list of int
        The accelerometer of each coil, counted from 0, in the pairing with the largest sum of levels.
    margin : float, dB
        The least, over the coils, of its own accelerometer over the loudest other; infinite when there is one.
    """
    rows, columns = linear_sum_assignment(-level)
    owner = {int(column): int(row) for row, column in zip(rows, columns, strict=True)}
    margins = []
    for coil in range(min(level.shape)):
        others = np.delete(level[:, coil], coil)
        margins.append(float(level[coil, coil] - others.max()) if len(others) else np.inf)
    return [owner.get(coil, -1) for coil in range(level.shape[1])], min(margins)


def polarity(each: Answers) -> np.ndarray:
    """Compare every coil's own accelerometer with the first one's at low frequency.

    Parameters
    ----------
    each : Answers

    Returns
    -------
    array, shape (sides,), 1
        1 where they move as one, -1 where one is inverted; the first is 1.
    """
    low = each.frequency <= LOW_END * each.frequency[0]
    own = np.array([each.response[low, side, side] for side in range(min(each.response.shape[1:]))])
    size = np.maximum(np.linalg.norm(own, axis=1), FAINT)
    likeness: np.ndarray = np.real(own @ own[0].conj()) / (size * size[0])
    return likeness
