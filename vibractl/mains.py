"""The mains' hum: followed from shot to shot by the silences, where nothing else is heard, and what it adds between."""

from collections import deque
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtri

NOMINAL = (50.0, 60.0)
"""Hz: what the mains may be."""
OFF = 0.07
"""Hz by which they may be off it, in operation: a tenth of a per cent and more."""
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
"""With which noise alone would be taken for a harmonic."""
STEADY = 1.5
"""1: so much louder may a harmonic be after the reference than before it; what is louder rings down."""
DISTINCT = 10.0
"""By which the logarithm of a phase's likelihood must be above that of any other which it may be mistaken for."""
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
        E |error of the amplitude|^2; of hum that is not subtracted, all of its power.
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

    def doubted(self, lines: np.ndarray, seconds: float, settled: bool = False) -> np.ndarray:
        """Return what may be left of it in the lines of a window, shape (lines, responses), (m/s^2 s)^2.

        Parameters
        ----------
        lines : array, shape (lines,), Hz
        seconds : float, s
            The window's length.
        settled : bool
            A Hann window of mean 1, over which a sine is judged; else a rectangle.
        """
        tones = self.frequency * np.arange(1, len(self.doubt) + 1)
        away = (lines[:, None] - tones) * seconds
        # a phase that is wrong between its ends lies half a cycle to each side, too
        kernel = 0.5 * np.sinc(away) ** 2 + 0.25 * (np.sinc(away - 1) ** 2 + np.sinc(away + 1) ** 2)
        if settled:
            kernel = (np.sinc(away) + 0.5 * np.sinc(away - 1) + 0.5 * np.sinc(away + 1)) ** 2
        power: np.ndarray = (seconds / 2) ** 2 * kernel @ self.doubt
        return power


class Mains:
    """Follows the mains through the silences of shot after shot.

    In pieces of 0.2 s the harmonics' amplitudes are measured under a Hann window.  In all pieces of the last shots they
    are one vector, turned by one phase a piece: harmonic h by h times that.  Phases and vector are estimated from each
    other; the phases before and after the reference give the frequency between.  What rings down from the drive is
    no hum: the vector is that of the silences before the reference, and see `stands_out`.

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
        every, orders, base = np.stack(self._shots), self._orders, self.frequency
        fit = aligned(every[:, :, 1::2], orders)
        loud = stands_out(every)
        kept = np.where(loud, fit.vector, 0.0)
        size, squares = np.abs(fit.vector) ** 2, orders[:, None] ** 2
        ratio = np.abs(kept) ** 2 / np.maximum(fit.scatter, TINY)
        self.clear = float(np.log1p(ratio[0] * len(every)).sum())
        known = 1 / np.maximum(2 * (ratio * squares).sum(axis=(1, 2)), TINY)
        spans = self._times - self._times[0]
        end = 1 + int(np.argmin((known + self._wandered(spans))[1:] + np.where(2 * OFF * spans < 1, 0.0, np.inf)[1:]))
        span = float(spans[end])
        turn = self._turned(fit.phase[-1, end] - fit.phase[-1, 0], span)
        if turn is None or not all(_is_distinct(every[-1, at, 1::2], kept, fit.scatter[at], orders) for at in (0, end)):
            return Hum(base, np.zeros_like(kept), np.where(loud, size, 0.0))
        self._go_on(turn)
        lost = squares * ((known[0] + known[end]) / 3 + self._wandered(span))
        doubt = np.where(loud, size * -np.expm1(-lost) + fit.variance, 0.0)
        start = fit.phase[-1, 0] - turn * self._times[0]
        turned = kept * np.exp(1j * orders * start)[:, None] * np.exp(-lost / 2)
        return Hum(base + turn / (2 * np.pi), turned, doubt)

    def _turned(self, turn: float, span: float) -> float | None:
        """Return how fast the phase turned beside the base, rad/s; None where that cannot be told from another turn."""
        off = self.frequency - self.nominal
        turn += 2 * np.pi * np.round(-off * span - turn / (2 * np.pi))
        is_told = span * 2 * OFF < 1 and abs(off + turn / span / (2 * np.pi)) <= OFF
        return turn / span if is_told else None

    def _go_on(self, turn: float) -> None:
        """Take the frequency of this shot for the next one's."""
        self._offs.append(self.frequency - self.nominal + turn / (2 * np.pi))
        self.frequency = self.nominal + self._offs[-1]

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
    """

    phase: np.ndarray
    vector: np.ndarray
    scatter: np.ndarray
    variance: np.ndarray


def aligned(pieces: np.ndarray, orders: np.ndarray) -> Fit:
    """Fit pieces by one vector, turned by a phase in each; the vector is that of the first place, before the reference.

    Parameters
    ----------
    pieces : complex array, shape (shots, places, harmonics, responses), m/s^2
    orders : int array, shape (harmonics,)
    """
    turns, shots = _turns(orders), len(pieces)
    vector = pieces[-1, 0]
    scatter = np.full(pieces.shape[1:], np.mean(np.abs(pieces) ** 2))
    for _ in range(ROUNDS):
        weight = 1 / np.maximum(scatter + EVEN * scatter.mean(axis=1, keepdims=True), TINY)
        match = np.einsum("spho,pho->sph", pieces, vector.conj() * weight)
        phase = _peak((match @ turns).real)
        turned = pieces * np.exp(-1j * phase[..., None] * orders)[..., None]
        vector = turned[:, 0].mean(axis=0)
        square = (np.abs(turned - vector) ** 2).sum(axis=0)
        scatter = (square + PRIOR * square.mean(axis=0)) / (shots + PRIOR - 1 / len(square))
    return Fit(phase, vector, scatter, scatter[0] / shots)


def stands_out(every: np.ndarray) -> np.ndarray:
    """Say which harmonics are hum before the reference, and not a mode that rings down: (harmonics, responses) of bool.

    There they are louder than chance makes them beside what lies half-way to the next, and hardly weaker than at the
    end of the shots.

    Parameters
    ----------
    every : complex array, shape (shots, places, 2 harmonics + 1, responses), m/s^2
    """
    power = (np.abs(every) ** 2).mean(axis=0)
    between = (power[:, :-1:2] + power[:, 2::2]) / 2
    before, last = power[0, 1::2], power[-1, 1::2]
    shots = len(every)
    loud = before > fdtri(2 * shots, 4 * shots, 1 - CHANCE) * between[0]
    lasting: np.ndarray = loud & (last - between[-1] < STEADY**2 * before)
    return lasting


def _is_distinct(piece: np.ndarray, vector: np.ndarray, scatter: np.ndarray, orders: np.ndarray) -> bool:
    """Say whether a piece (harmonics, responses) tells its phase from all that fewer harmonics could not tell apart."""
    match = (piece * vector.conj() / np.maximum(scatter, TINY)).sum(axis=1)
    likelihood = 2 * (match @ _turns(orders)).real
    best = int(likelihood.argmax())
    others = {round(GRID * k / n) % GRID for n in range(2, len(orders) + 1) for k in range(1, n)}
    return bool(likelihood[best] - likelihood[[(best + other) % GRID for other in others]].max() > DISTINCT)


def _turns(orders: np.ndarray) -> np.ndarray:
    """Return what turns each harmonic back by each phase that is tried, (harmonics, phases)."""
    turns: np.ndarray = np.exp(-2j * np.pi / GRID * np.outer(orders, np.arange(GRID)))
    return turns


def _peak(score: np.ndarray) -> np.ndarray:
    """Return where `score` is largest along its last axis, which is one turn, rad: a parabola through three values."""
    best = score.argmax(axis=-1)[..., None]
    before, here, after = (np.take_along_axis(score, (best + step) % GRID, -1)[..., 0] for step in (-1, 0, 1))
    bend = before - 2 * here + after
    shift = np.where(bend < 0, 0.5 * (before - after) / np.where(bend < 0, bend, 1.0), 0.0)
    place: np.ndarray = 2 * np.pi * (best[..., 0] + np.clip(shift, -0.5, 0.5)) / GRID
    return place
