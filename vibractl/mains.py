"""The mains' hum: followed from shot to shot by the silences, where nothing else is heard, and what it adds between."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtri

NOMINAL = (50.0, 60.0)
"""Hz: what the mains may be."""
OFF = 0.12
"""Hz by which they may be off it."""
PIECE = 0.2
"""s, of a silence, over which an amplitude is measured."""
TAILS = 5
"""Pieces of the silence after the reference, at most."""
KEPT = 12
"""Shots by which the harmonics' amplitudes are known."""
WANDER = 0.003
"""Hz, rms change of the mains from shot to shot that is assumed until it is known; it counts as one shot."""
ROUNDS = 4
"""Times that phases and amplitudes are estimated from each other."""
GRID = 512
"""Phases that are tried in a turn."""
CHANCE = 1e-3
"""With which noise alone would be taken for a harmonic; one that is not beyond it is not subtracted."""
EVEN = 0.1
"""1, of the mean scatter of the harmonics, what is added to each where they are weighed: few pieces know it badly."""
PRIOR = 2.0
"""Shots that the scatter of all places together counts for in that of each."""
TINY = 1e-100
"""(m/s^2)^2: no variance is taken to be smaller, so that its inverse has a square."""


Pieces = tuple[np.ndarray, ...]
"""Amplitudes (places, 2 harmonics + 1, responses), m/s^2, for each of `NOMINAL`: at 1/2, 1, 3/2, 2, ... of it."""


@dataclass(frozen=True, eq=False)
class Hum:
    """The hum in a shot: tones at multiples of one frequency.

    Parameters
    ----------
    frequency : float, Hz
        Of the first harmonic, as it was during the shot.
    amplitude : complex array, shape (harmonics, responses), m/s^2
        Of sum over h Re a_h exp(j 2 pi h f t), t from the shot's first sample.
    doubt : array, shape (harmonics, responses), (m/s^2)^2
        E |error of the amplitude|^2.
    """

    frequency: float
    amplitude: np.ndarray
    doubt: np.ndarray

    def signal(self, samples: int, rate: float) -> np.ndarray:
        """Return the hum in the first samples of the shot, shape (samples, responses), m/s^2, at `rate` samples/s."""
        turn = np.exp(2j * np.pi * self.frequency / rate * np.arange(samples))
        heard, tone = np.zeros((samples, self.amplitude.shape[1])), np.ones_like(turn)
        for amplitude in self.amplitude:
            tone = tone * turn
            if amplitude.any():
                heard += np.outer(tone.real, amplitude.real) - np.outer(tone.imag, amplitude.imag)
        return heard

    def doubted(self, lines: np.ndarray, seconds: float) -> np.ndarray:
        """Return what may be left of it in the lines of a window, shape (lines, responses), (m/s^2 s)^2.

        Parameters
        ----------
        lines : array, shape (lines,), Hz
        seconds : float, s
            The window's length.
        """
        tones = self.frequency * np.arange(1, len(self.doubt) + 1)
        kernel = (seconds / 2 * np.sinc((lines[:, None] - tones) * seconds)) ** 2
        power: np.ndarray = kernel @ self.doubt
        return power


class Mains:
    """Follows the mains through the silences of shot after shot.

    In pieces of 0.2 s the harmonics' amplitudes are measured under a Hann window.  In all pieces of the last shots they
    are one vector, turned by one phase a piece: harmonic h by h times that.  Phases and vector are estimated from each
    other; the phases before and after the reference give the frequency between.  What rings down from the drive is
    locked to the shot and not to the mains: it scatters, and pieces count by how little they do.  A harmonic that is
    no louder than what lies half-way to the next is none.

    Parameters
    ----------
    lead, tail : int, samples
        Of silence before the reference, and after it.
    total : int, samples
        Of the shot.
    rate : float, samples/s
    highest : float, Hz
        Harmonics up to here are followed.

    Source
    ------
    Christensen and Jakobsson 2009, Multi-Pitch Estimation, ch. 2: one phase in many harmonics, by maximum likelihood.
    """

    def __init__(self, lead: int, tail: int, total: int, rate: float, highest: float) -> None:
        self._rate, self._length, self._highest = rate, min(round(PIECE * rate), lead, tail), highest
        tails = np.linspace(total - tail, total - self._length, max(1, min(TAILS, tail // self._length)) + 1)[1:]
        self._starts = [(lead - self._length) // 2, *(int(start) for start in tails)]
        self._times = (np.array(self._starts) + (self._length - 1) / 2) / rate
        window = np.hanning(self._length + 2)[1:-1]
        self._window = 2 * window / window.sum()
        self.restart()

    def restart(self) -> None:
        """Know nothing of the mains."""
        self._tracks = [_Track(each, int(self._highest / (each + OFF)), self._times) for each in NOMINAL]

    def observe(self, response: np.ndarray) -> Hum:
        """Take a shot's response, shape (at least the shot, responses), m/s^2; return the hum in it."""
        return self.follow(self.measure(response))

    def measure(self, response: np.ndarray) -> Pieces:
        """Return what the silences of a response, shape (at least the shot, responses), m/s^2, show."""
        pieces = np.stack([response[start : start + self._length] for start in self._starts])
        pieces = pieces - pieces.mean(axis=1, keepdims=True)
        return tuple(self._amplitudes(pieces, track.frequency * track.halves) for track in self._tracks)

    def follow(self, pieces: Pieces) -> Hum:
        """Take what `measure` gave of a shot; return the hum in it."""
        found = [track.take(each) for track, each in zip(self._tracks, pieces, strict=True)]
        return found[int(np.argmax([track.clear for track in self._tracks]))]

    def _amplitudes(self, pieces: np.ndarray, frequency: np.ndarray) -> np.ndarray:
        """Return amplitudes at frequencies, (tones,), Hz, by the shot's time: (places, tones, responses), m/s^2."""
        cycles = frequency / self._rate
        tones = self._window * np.exp(-2j * np.pi * np.outer(cycles, np.arange(self._length)))
        turn = np.exp(-2j * np.pi * np.outer(self._starts, cycles))
        amplitudes: np.ndarray = turn[..., None] * (tones @ pieces)
        return amplitudes


class _Track:
    """The mains at one of their nominal frequencies: the pieces of the last shots, and how far off they are."""

    def __init__(self, nominal: float, harmonics: int, times: np.ndarray) -> None:
        self.nominal, self.frequency, self.clear = nominal, nominal, 0.0
        self.halves, self._orders = np.arange(0.5, harmonics + 1, 0.5), np.arange(1, harmonics + 1)
        self._times = times
        self._shots: deque[np.ndarray] = deque(maxlen=KEPT)
        self._offs: deque[float] = deque(maxlen=KEPT)

    def take(self, pieces: np.ndarray) -> Hum:
        """Take the pieces of a shot, see `Pieces`; return the hum in it."""
        self._shots.append(pieces)
        every, orders = np.stack(self._shots), self._orders
        fit = aligned(every[:, :, 1::2], orders)
        size = np.abs(fit.vector) ** 2
        certain = (size > _threshold(fit.freedom) * fit.variance) & _stands_out(
            every, 1 / np.maximum(fit.scatter, TINY)
        )
        ratio = np.where(certain, size / np.maximum(fit.variance, TINY), 0.0)
        self.clear += float(np.log1p(ratio).sum())
        kept = np.where(certain, fit.vector, 0.0)
        squares = orders[:, None] ** 2
        known = 1 / np.maximum(2 * (np.abs(kept) ** 2 * squares / np.maximum(fit.scatter, TINY)).sum(axis=(1, 2)), TINY)
        end = 1 + int(np.argmin(known[1:] + self._wandered(self._times[1:] - self._times[0])))
        base, span = self.frequency, float(self._times[end] - self._times[0])
        turn = self._turned(fit.phase[-1, end] - fit.phase[-1, 0], span)
        spread = (known[0] + known[end]) / 3 + self._wandered(span)
        doubt = np.where(certain, np.minimum(size, size * squares * spread), size) + fit.variance
        start = fit.phase[-1, 0] - turn * self._times[0]
        return Hum(base + turn / (2 * np.pi), kept * np.exp(1j * orders * start)[:, None], doubt)

    def _turned(self, turn: float, span: float) -> float:
        """Return how fast the phase turned beside the base, rad/s, and take that frequency for the next shot's."""
        base = self.frequency - self.nominal
        expected = self._offs[-1] if self._offs else 0.0
        turn += 2 * np.pi * np.round((expected - base) * span - turn / (2 * np.pi))
        self._offs.append(float(np.clip(base + turn / span / (2 * np.pi), -OFF, OFF)))
        self.frequency = self.nominal + self._offs[-1]
        return turn / span

    def _wandered(self, span: np.ndarray | float) -> np.ndarray | float:
        """Return the mean square, rad^2, by which a phase leaves the line between its ends when its frequency walks."""
        steps = np.append(np.diff(self._offs), WANDER)
        return (2 * np.pi * span) ** 2 / 60 * float(np.mean(steps**2))


@dataclass(frozen=True, eq=False)
class Fit:
    """Pieces as one vector turned by a phase in each: c(s, p) = a exp(j h phi(s, p)) + scatter.

    Parameters
    ----------
    phase : array, shape (shots, places), rad
    vector : complex array, shape (harmonics, responses), m/s^2
        a.
    scatter : array, shape (places, harmonics, responses), (m/s^2)^2
        Variance of a piece about it.
    variance : array, shape (harmonics, responses), (m/s^2)^2
        Of the vector.
    freedom : array, shape (harmonics, responses), >= 1
        Complex degrees, by which the variance is known.
    """

    phase: np.ndarray
    vector: np.ndarray
    scatter: np.ndarray
    variance: np.ndarray
    freedom: np.ndarray


def aligned(pieces: np.ndarray, orders: np.ndarray) -> Fit:
    """Fit pieces by one vector, turned by a phase in each.

    Parameters
    ----------
    pieces : complex array, shape (shots, places, harmonics, responses), m/s^2
    orders : int array, shape (harmonics,)
    """
    grid = 2 * np.pi * np.arange(GRID) / GRID
    turns = np.exp(-1j * np.outer(orders, grid))
    shots, places = pieces.shape[:2]
    vector = pieces[-1, 0]
    scatter = np.full(pieces.shape[1:], np.mean(np.abs(pieces) ** 2))
    for _ in range(ROUNDS):
        weight = 1 / np.maximum(scatter + EVEN * scatter.mean(axis=1, keepdims=True), TINY)
        match = np.einsum("spho,pho->sph", pieces, vector.conj() * weight)
        phase = _peak((match @ turns).real)
        turned = pieces * np.exp(-1j * phase[..., None] * orders)[..., None]
        vector = np.einsum("spho,pho->ho", turned, weight) / (shots * weight.sum(axis=0))
        square = (np.abs(turned - vector) ** 2).sum(axis=0)
        pooled = square.sum(axis=0) / max(shots * places - 1, 1)
        scatter = (square + PRIOR * pooled) / (shots + PRIOR - 1 / places)
    weight = 1 / np.maximum(scatter, TINY)
    counting = weight.sum(axis=0) ** 2 / (weight**2).sum(axis=0)
    return Fit(phase, vector, scatter, 1 / (shots * weight.sum(axis=0)), np.maximum(shots * counting - 1, 1))


def _stands_out(every: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Say which harmonics are louder than chance makes them beside what lies between, (harmonics, responses) of bool.

    Parameters
    ----------
    every : complex array, shape (shots, places, 2 harmonics + 1, responses), m/s^2
    weight : array, shape (places, harmonics, responses), (m/s^2)^-2
    """
    power = (np.abs(every) ** 2).mean(axis=0)
    between = (power[:, :-1:2] + power[:, 2::2]) / 2
    count = 2 * every.shape[0] * every.shape[1]
    ratio = (weight * power[:, 1::2]).sum(axis=0) / np.maximum((weight * between).sum(axis=0), TINY)
    loud: np.ndarray = ratio > fdtri(count, 2 * count, 1 - CHANCE)
    return loud


def _peak(score: np.ndarray) -> np.ndarray:
    """Return where `score` is largest along its last axis, which is one turn, rad: a parabola through three values."""
    best = score.argmax(axis=-1)[..., None]
    before, here, after = (np.take_along_axis(score, (best + step) % GRID, -1)[..., 0] for step in (-1, 0, 1))
    bend = before - 2 * here + after
    shift = np.where(bend < 0, 0.5 * (before - after) / np.where(bend < 0, bend, 1.0), 0.0)
    place: np.ndarray = 2 * np.pi * (best[..., 0] + np.clip(shift, -0.5, 0.5)) / GRID
    return place


def _threshold(freedom: np.ndarray) -> np.ndarray:
    """Return what |a|^2 re its variance exceeds with `CHANCE` for noise: the F distribution of 2 and 2 `freedom`."""
    bound: np.ndarray = freedom * (CHANCE ** (-1 / freedom) - 1)
    return bound
