"""What else changes a response from shot to shot: noise, and distortion that follows the drive's strong lines."""

from collections import deque

import numpy as np

from vibractl.learning.laws import strong_lines

QUIET_REACH = 15
"""Bins to each side over which the noise in the silence is a median: hum is left out."""
FLOOR = 1e-6
"""Of the reference's level: a disturbance is never taken to be smaller."""


MOST = 1e6
"""A change of the strong lines is never taken to be larger: a sensor that was dead changes by an infinite part."""
LEAST = 0.25
"""Coupling that is measured is never taken to be smaller: G itself does not explain everything."""
CLEAR = 0.1
"""Of the noise's power: a change of distortion from which on it says how much distortion changes."""
KEPT = 6
"""Measured couplings of which the geometric mean counts; what is configured is the first of them."""


class Disturbance:
    """Expects how strongly a response changes beyond what G says of the change of drive.

    Distortion of a line, D = Y - G U, comes from the strong lines of the reference.  When those change by a part
    delta, it changes by some multiple of delta |D|, whatever the drive at the line itself does.  At the strong lines
    that multiple is measured from shot to shot, as innovations show it; at the others it stays as configured.  Where
    lines stand apart, a strong one follows no other: what G does not explain there says that G is another one at this
    drive.

    Parameters
    ----------
    reference : complex array, shape (lines, outputs), m/s^2 s
    coupling : float, 1, >= 0
        The multiple, at most; a distortion of order n changes by n times.
    reach : int, lines to each side over which |D|^2 is averaged; 0 where lines stand apart

    Attributes
    ----------
    strong : array, shape (lines,) of bool
        Lines of the reference's own band.
    tones : array, shape (lines,) of bool
        Strong lines that stand apart.

    Source
    ------
    Mehra 1970, "On the identification of variances and adaptive Kalman filtering", IEEE Trans. Autom. Control 15(2),
    for what innovations say of the noise.
    """

    def __init__(self, reference: np.ndarray, coupling: float, reach: int) -> None:
        self.strong = strong_lines(reference)
        self.tones = self.strong & (reach == 0)
        self._coupling, self._reach = coupling, reach
        self._measured = deque([np.log(max(coupling, LEAST))], maxlen=KEPT)
        self._floor = (FLOOR * float(np.abs(reference).max())) ** 2

    def power(self, noise: np.ndarray, distortion: np.ndarray, change: float) -> np.ndarray:
        """Return E |v|^2 of each line.

        Parameters
        ----------
        noise : array, shape (lines, outputs), (m/s^2 s)^2
        distortion : array, shape (lines, outputs), (m/s^2 s)^2
            |Y - G U|^2.
        change : float, 1
            delta, see `change`.

        Returns
        -------
        array, shape (lines, outputs), (m/s^2 s)^2
        """
        spread = np.where(self.tones[:, None], 0.0, smoothed(distortion, self._reach))
        coupling = np.where(self.strong, self.coupling, self._coupling)
        total: np.ndarray = noise + (coupling[:, None] * change) ** 2 * spread + self._floor
        return total

    @property
    def coupling(self) -> float:
        """By how many times a change of the strong lines changes what G does not explain of them."""
        return min(float(np.exp(np.mean(self._measured))), self._coupling)

    def observe(self, surprise: np.ndarray, noise: np.ndarray, distortion: np.ndarray, change: float) -> None:
        """Measure the coupling of the strong lines by what a change of drive did beside what G says.

        Parameters
        ----------
        surprise : array, shape (lines, outputs), (m/s^2 s)^2
            |dY - G dU|^2.
        noise, distortion, change
            As of `power`.
        """
        surplus = float((surprise - noise)[self.strong].sum())
        expected = change**2 * float(smoothed(distortion, self._reach)[self.strong].sum())
        if expected > CLEAR * float(noise[self.strong].sum()):
            self._measured.append(0.5 * np.log(max(surplus / expected, LEAST**2)))

    def change(self, step: np.ndarray, response: np.ndarray) -> float:
        """Return delta: how much `step` changes the strong lines of a response, both (lines, outputs), m/s^2 s."""
        size, moved = (np.linalg.norm(lines[self.strong], axis=0) for lines in (response, step))
        parts = moved / np.maximum(size, np.maximum(moved / MOST, np.finfo(float).tiny))
        return float(parts.max())


CHANCE = 0.05
"""With which noise alone goes beyond what is allowed for it on any line of a shot."""


def noise_reach(power: np.ndarray | float, lines: int) -> np.ndarray:
    """Return the power that noise alone reaches on any of so many lines only by `CHANCE`, of any unit.

    Parameters
    ----------
    power : array, shape (lines, outputs), or float
        E |N|^2 of a line.
    lines : int, >= 1

    Returns
    -------
    array, shape (lines, outputs)
    """
    reach: np.ndarray = power * np.log(lines / CHANCE)
    return reach


def smoothed(power: np.ndarray, reach: int) -> np.ndarray:
    """Average over `reach` lines to each side, mirrored at the ends.

    Parameters
    ----------
    power : array, shape (lines, outputs), any unit
    reach : int, lines

    Returns
    -------
    array, shape (lines, outputs)
    """
    if reach == 0:
        return power
    padded = np.pad(power, ((reach + 1, reach), (0, 0)), mode="reflect")
    total = np.cumsum(padded, axis=0)
    mean: np.ndarray = (total[2 * reach + 1 :] - total[: -2 * reach - 1]) / (2 * reach + 1)
    return mean


def noise_power(silence: np.ndarray, rate: float, frequency: np.ndarray, frames: int) -> np.ndarray:
    """Estimate the noise in the lines of a shot from the silence before it.

    Parameters
    ----------
    silence : array, shape (samples, outputs), m/s^2
    rate : float, samples/s
    frequency : array, shape (lines,), Hz
    frames : int, samples
        Of the shot whose lines are meant.

    Returns
    -------
    array, shape (lines, outputs), (m/s^2 s)^2
        E |N|^2; a median over neighbouring bins, so that hum does not raise it.
    """
    samples = len(silence)
    window = np.hanning(samples + 2)[1:-1, None]
    bins = np.abs(np.fft.rfft(window * silence, axis=0) / rate) ** 2 / (window**2).mean() * (frames / samples)
    reach = min(QUIET_REACH, (len(bins) - 1) // 2)
    padded = np.pad(bins, ((reach, reach), (0, 0)), mode="reflect")
    median = np.median(np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=0), axis=-1) / np.log(2)
    place = frequency * samples / rate
    return np.column_stack([np.interp(place, np.arange(len(median)), column) for column in median.T])
