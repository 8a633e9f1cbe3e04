"""Periodic multisines in recordings: their period, their mean when settled, noise and distortion beside the lines."""

from dataclasses import dataclass

import numpy as np

from calibration.recorded_response import Spectrum

SHORTEST_PERIOD = 0.5
"""s: lines of a shorter one are more than 2 Hz apart."""
LIKE = 0.3
"""Correlation of a drive with itself a period later, at least, where it may be periodic: several multisines may follow
each other."""
SAME = 1e-3
"""Part of its power by which a period may differ from the one before: what a recorded drive's noise makes of it."""
MOST = 0.5
"""Part of the drives' energy that must lie in periods that come again, for a recording to be taken as periodic."""
EXCITED, DARK = 10 ** (-50 / 20), 10 ** (-65 / 20)
"""Of a drive's strongest line: above the one a line is excited, below the other it is not, and shows distortion."""
FEWEST = 32
"""Excited lines of a multisine."""
SETTLED = 1.5
"""Times what noise makes of it, by which a first period may be off the others and counts as settled."""


@dataclass(frozen=True)
class Multisine:
    """What periods that come again tell of noise and distortion, dB re the response's excited lines, by output.

    Parameters
    ----------
    period : float, s
    averages : int
        Periods that are averaged, over all multisines of the recording.
    multisines : int
        That differ.
    noise : array, shape (outputs,), dB
        From period to period; NaN where there is one alone.
    even, odd : arrays, shape (outputs,), dB
        On lines that are not excited, without the noise; NaN where there is no such line.
    """

    period: float
    averages: int
    multisines: int
    noise: np.ndarray
    even: np.ndarray
    odd: np.ndarray


def find_period(drive: np.ndarray, rate: float, factor: int) -> int | None:
    """Find the period of a drive, or of the multisines that it is a sequence of.

    Parameters
    ----------
    drive : array, shape (samples, inputs), V
    rate : float, samples/s
    factor : int
        By which the rate was lowered.

    Returns
    -------
    int or None
        Samples at the full rate.
    """
    samples, shortest = len(drive), round(SHORTEST_PERIOD * rate)
    if samples < 2 * shortest + 2 or not drive.any():
        return None
    points = 2 * samples
    power = (np.abs(np.fft.rfft(drive, points, axis=0)) ** 2).sum(axis=1)
    energy = np.concatenate(([0.0], np.cumsum((drive**2).sum(axis=1))))
    lags = np.arange(samples - shortest)
    both = (energy[samples - lags] - energy[0]) + (energy[samples] - energy[lags])
    like = 2 * np.fft.irfft(power, points)[: len(lags)] / np.maximum(both, 1e-3 * energy[-1])
    peaks = 1 + np.flatnonzero((like[1:-1] >= like[:-2]) & (like[1:-1] >= like[2:]) & (like[1:-1] > LIKE))
    peaks = peaks[peaks >= shortest]
    if not len(peaks):
        return None
    best = peaks[like[peaks] >= 0.9 * like[peaks].max()][0]
    return _agreed(drive, factor * _refined(power, points, int(best)), factor)


def _refined(power: np.ndarray, points: int, lag: int) -> float:
    """Return where around a lag the correlation is largest."""
    omega = 2 * np.pi * np.arange(len(power)) / points
    place = float(lag)
    for _ in range(6):
        wave = power * np.exp(1j * omega * place)
        slope, bend = -float((omega * wave.imag).sum()), -float((omega**2 * wave.real).sum())
        if bend >= 0:
            break
        place -= float(np.clip(slope / bend, -0.5, 0.5))
    return place


def _agreed(drive: np.ndarray, near: float, factor: int) -> int | None:
    """Return the whole number of samples after which most of a drive comes again."""
    candidates = sorted(range(round(near) - 3, round(near) + 4), key=lambda period: abs(period - near))
    shares = [_share_again(drive, period / factor) for period in candidates]
    best = int(np.argmax(shares))
    return candidates[best] if shares[best] >= 0.5 * MOST else None


def _share_again(drive: np.ndarray, period: float) -> float:
    """Return the part of a drive's energy that comes again, in pieces of a twentieth of a period."""
    points = 2 * len(drive)
    turn = np.exp(2j * np.pi * np.arange(points // 2 + 1) / points * period)
    moved = np.fft.irfft(np.fft.rfft(drive, points, axis=0) * turn[:, None], points, axis=0)
    common, piece = len(drive) - int(np.ceil(period)), max(int(period / 20), 1)
    count = common // piece
    own = (drive[: count * piece] ** 2).reshape(count, -1).sum(axis=1)
    off = ((moved[: count * piece] - drive[: count * piece]) ** 2).reshape(count, -1).sum(axis=1)
    return float(own[off <= SAME * own].sum() / max(own.sum(), np.finfo(float).tiny))


class Periods:
    """Averages the periods that come again, multisine by multisine, as they are read.

    Parameters
    ----------
    period : float, s

    Source
    ------
    Pintelon and Schoukens 2012, System Identification, sec. 4.3: noise from period to period, distortion on the lines
    that are not excited.
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self._runs: list[_Run] = []
        self._energy = 0.0

    def add(self, block: Spectrum) -> None:
        """Take the next period."""
        energy = float((np.abs(block.drive) ** 2).sum())
        self._energy += energy
        last = self._runs[-1] if self._runs else None
        if last is not None and float((np.abs(block.drive - last.drive) ** 2).sum()) <= SAME * energy:
            last.add(block)
            return
        if last is not None and not last.count:
            self._runs.pop()
        self._runs.append(_Run(block))

    def averaged(self) -> tuple[list[Spectrum], Multisine] | None:
        """Return what came again.

        Returns
        -------
        spectra : list of Spectrum
            The mean of each multisine at its excited lines.
        told : Multisine
        None : less than `MOST` of the drives' energy comes again, or too few lines are excited.
        """
        runs = [run for run in self._runs if run.count and run.energy > 1e-3 * self._energy]
        if not runs or sum(run.energy for run in runs) < MOST * self._energy:
            return None
        means, parts, count = [], [], 0
        for run in runs:
            mean, scatter, averages = run.settled()
            size = np.abs(mean.drive) / np.abs(mean.drive).max()
            excited, dark = (size > EXCITED).any(axis=1), (size < DARK).all(axis=1)
            if np.count_nonzero(excited) < FEWEST:
                return None
            parts.append(_levels(mean, scatter, averages, excited, dark, 1 / self._period))
            count += averages
            drive, response = mean.drive[excited], mean.response[excited]
            means.append(Spectrum(mean.frequency[excited], drive, response, mean.middle, is_steady=True))
        power, *others = (np.mean(each, axis=0) for each in zip(*parts, strict=True))
        noise, even, odd = (10 * np.log10(np.maximum(each, 1e-30) / power) for each in others)
        return means, Multisine(self._period, count, len(runs), noise, even, odd)


class _Run:
    """A period, and those after it that have the same drive, summed."""

    def __init__(self, first: Spectrum) -> None:
        self._first, self.drive = first, first.drive
        self.count, self.energy = 0, float((np.abs(first.drive) ** 2).sum())
        self._drives, self._responses = (np.zeros(each.shape, complex) for each in (first.drive, first.response))
        self._power = np.zeros(first.response.shape)

    def add(self, block: Spectrum) -> None:
        self.drive = block.drive
        self.count += 1
        self.energy += float((np.abs(block.drive) ** 2).sum())
        self._drives += block.drive
        self._responses += block.response
        self._power += np.abs(block.response.astype(complex)) ** 2

    def settled(self) -> tuple[Spectrum, np.ndarray, int]:
        """Return the mean, how periods scatter around it, (bins, outputs), NaN for one alone, and how many there are.

        The first one is among them where others say that it has settled.
        """
        response, scatter = self._mean(), self._scatter()
        off = float((np.abs(self._first.response - response) ** 2).sum())
        if self.count > 1 and off <= SETTLED * float(scatter.sum()) * (1 + 1 / self.count):
            self.add(self._first)
            response, scatter = self._mean(), self._scatter()
        mean = Spectrum(self._first.frequency, self._drives / self.count, response, self._first.middle)
        return mean, scatter, self.count

    def _mean(self) -> np.ndarray:
        return self._responses / self.count

    def _scatter(self) -> np.ndarray:
        if self.count < 2:
            return np.full(self._power.shape, np.nan)
        scatter: np.ndarray = np.maximum(self._power - self.count * np.abs(self._mean()) ** 2, 0.0) / (self.count - 1)
        return scatter


def _levels(
    mean: Spectrum, scatter: np.ndarray, averages: int, excited: np.ndarray, dark: np.ndarray, spacing: float
) -> tuple[np.ndarray, ...]:
    """Return the mean power of a line, (outputs,): response, noise, even and odd distortion."""
    harmonic = np.rint(mean.frequency / spacing).astype(int)
    band = (harmonic >= harmonic[excited][0]) & (harmonic <= harmonic[excited][-1])
    power = np.abs(mean.response) ** 2
    beyond = power - np.where(np.isfinite(scatter), scatter, 0.0) / averages
    found = [power[excited].mean(axis=0), scatter[band].mean(axis=0)]
    for parity in (0, 1):
        chosen = dark & band & (harmonic % 2 == parity)
        there = np.maximum(beyond[chosen].mean(axis=0), 0.0) if chosen.any() else np.full(power.shape[1], np.nan)
        found.append(there)
    return tuple(found)
