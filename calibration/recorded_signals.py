"""A recorded pair of files as blocks of lines: drives and responses read beside each other, never held as a whole."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.fft import irfft, next_fast_len, prev_fast_len, rfft

from calibration.recorded_response import Spectrum
from ctlblocks.recording import RecordingError
from rigkit.foreign_stream import Signals
from vibractl.capture import FULL_SCALE

READ = 2**16
"""Samples read at once."""
BLOCK = 20.0
"""s of a block, about: so much is in memory at the full rate, and a transient is paid for once in it."""
HEAD = 60.0
"""s at the beginning in which lag, period and clock are looked for."""
SHORTEST = 2.0
"""s, a block at least: resonances are 1 Hz wide."""
PASSED, ROOM = 0.6, 256
"""Of the lower rate's half, from where on a beginning is faded out; and samples behind it for that to ring."""
TAPS, BEFORE = 6, 2
"""Of the Lagrange polynomial by which a response is stretched: 650 Hz at 44.1 kHz to 1e-8, at 8 kHz to 1e-4;
and those before a sample."""


@dataclass(frozen=True)
class Recorded:
    """A recording that a model comes from.

    Parameters
    ----------
    drive : Signals, V
    response : Signals, m/s^2
        Begun together with the drive, or nearly.
    full_scale : float, m/s^2
        The largest response that the recorder knows.
    """

    drive: Signals
    response: Signals
    full_scale: float = float("inf")

    @property
    def name(self) -> str:
        """The responses'."""
        return str(self.response.path)

    @property
    def rate(self) -> float:
        """Samples/s."""
        return self.drive.rate


@dataclass(frozen=True)
class Head:
    """The beginning of a recording at a lower rate.

    Parameters
    ----------
    drive : array, shape (samples, inputs), V
    response : array, shape (samples, outputs), m/s^2
    rate : float, samples/s
    """

    drive: np.ndarray
    response: np.ndarray
    rate: float


@dataclass(frozen=True)
class Course:
    """How a recording is read.

    Parameters
    ----------
    late : int, samples
        By which responses come after drives.
    drift : float, 1
        By which the recorder's clock is faster; it is taken out.
    length, hop : int, samples
        Of a block, and from one's beginning to the next one's.
    lead : int, samples
        Of silence before the first.
    is_whole : bool
        Whether what is left in the end counts only if it is as long as a block.
    band : (float, float), Hz
    """

    late: int
    drift: float
    length: int
    hop: int
    lead: int
    is_whole: bool
    band: tuple[float, float]


def head_of(record: Recorded, factor: int, seconds: float = HEAD) -> Head:
    """Read the beginning of a recording.

    Parameters
    ----------
    record : Recorded
    factor : int
        By which the rate is lowered.
    seconds : float, s
    """
    samples = round(seconds * record.rate)
    drive, response = (_beginning(signals, samples, factor) for signals in (record.drive, record.response))
    return Head(drive, response, record.rate / factor)


def blocks_of(record: Recorded, course: Course) -> Iterator[Spectrum]:
    """Read a recording block by block, and give the lines of a band of each.

    Parameters
    ----------
    record : Recorded
    course : Course

    Raises
    ------
    RecordingError : it cannot be read to its end, or a response is clipped or never changes.
    """
    rate = record.rate
    drive, response = _Reader(record.drive), _Reader(record.response, record.full_scale)
    first, stretch = max(0, -course.late) - course.lead, 1 + course.drift
    least = course.length if course.is_whole else round(SHORTEST * rate)
    while True:
        place = (first + course.late) * stretch
        begin = int(np.floor(place)) - BEFORE
        heard = response.window(begin, int(np.ceil(course.length * stretch)) + TAPS)
        there = min(course.length, int((response.end - place) / stretch))
        if there < least:
            break
        there = there if course.is_whole or there == course.length else int(prev_fast_len(there))
        moved = _stretched(heard, place - begin, stretch, there)
        found = lines_of(drive.window(first, there), moved, rate, course.band, (first + there / 2) / rate)
        del heard, moved  # nothing of a block is held while its lines are looked at
        yield replace(found, fresh=1 + min(first, 0) / there if course.lead else 1.0)
        first += course.hop
    response.refuse_still()


def block_length(samples: int, rate: float) -> int:
    """Return the samples of each of some equal blocks that a recording of so many is cut into."""
    blocks = max(int(np.ceil(samples / (BLOCK * rate))), 1)
    return int(prev_fast_len(samples // blocks))


class _Reader:
    """Windows of signals one after the other, and silence before and behind them; one copy of a window is held."""

    def __init__(self, signals: Signals, full_scale: float = float("inf")) -> None:
        self._signals, self._parts, self._full_scale = signals, signals.blocks(READ), full_scale
        width = len(signals.names)
        self._held = np.zeros((0, width))
        self._first = self.end = 0
        """What is held begins here, and signals were read so far: all of it once a window has reached beyond."""
        self._is_ended = False
        self._least, self._most = np.full(width, np.inf), np.full(width, -np.inf)

    def window(self, first: int, count: int) -> np.ndarray:
        """Return samples `first` to `first` + `count`, until the next call; they must not go back."""
        if len(self._held) < count + READ:
            self._held = np.concatenate((self._held, np.zeros((count + READ - len(self._held), self._held.shape[1]))))
        kept = max(self.end - max(first, self._first), 0)
        self._held[:kept] = self._held[self.end - kept - self._first : self.end - self._first].copy()
        self._first = self.end - kept
        while self.end < first + count and not self._is_ended:
            part = next(self._parts, None)
            if part is None:
                self._is_ended = True
            else:
                self._take(part, first)
        taken = self._held[: self.end - self._first]
        if self._first == first and len(taken) >= count:
            return taken[:count]
        before = min(max(self._first - first, 0), count)
        behind = max(count - before - len(taken), 0)
        return np.pad(taken[: count - before], ((before, behind), (0, 0)))

    def refuse_still(self) -> None:
        """Refuse a channel that has never changed."""
        still = ~(self._most > self._least)
        if still.any():
            raise RecordingError(f"{self._signals.path}: response {int(still.argmax()) + 1} never changes, must move")

    def _take(self, part: np.ndarray, first: int) -> None:
        self._look(part)
        skipped = min(max(first - self.end, 0), len(part)) if self.end == self._first else 0
        self._first += skipped
        place = self.end + skipped - self._first
        self._held[place : place + len(part) - skipped] = part[skipped:]
        self.end += len(part)

    def _look(self, part: np.ndarray) -> None:
        self._least, self._most = np.minimum(self._least, part.min(axis=0)), np.maximum(self._most, part.max(axis=0))
        limit = FULL_SCALE * self._full_scale
        if np.maximum(self._most, -self._least).max() >= limit:
            sample, channel = np.argwhere(np.abs(part) >= limit)[0]
            raise RecordingError(
                f"{self._signals.path}: response {channel + 1} is clipped at full scale, {self._full_scale:g} "
                f"m/s^2, at {(self.end + sample) / self._signals.rate:.4f} s, must stay below: record with less gain"
            )


def _beginning(signals: Signals, samples: int, factor: int) -> np.ndarray:
    """Read the first samples and lower their rate, channel by channel, without a shift in time."""
    longest = samples if signals.frames is None else min(samples, signals.frames)
    whole, count = np.empty((longest, len(signals.names)), np.float32), 0
    for part in signals.blocks(READ):
        taken = part[: longest - count]
        whole[count : count + len(taken)] = taken
        count += len(taken)
        if count == longest:
            break
    whole = whole[:count]
    kept = -(-len(whole) // factor)
    points = next_fast_len(kept + ROOM, real=True)
    fade = np.clip((1 - np.arange(points // 2 + 1) * 2 / points) / (1 - PASSED), 0, 1)
    weight = (0.5 - 0.5 * np.cos(np.pi * fade)) / factor
    lines = (rfft(channel, factor * points)[: len(weight)] for channel in whole.T)
    return np.column_stack([irfft(each * weight, points)[:kept] for each in lines])


def lines_of(
    drive: np.ndarray, response: np.ndarray, rate: float, band: tuple[float, float], middle: float
) -> Spectrum:
    """Transform a block.

    Parameters
    ----------
    drive : array, shape (samples, inputs), V
    response : array, shape (samples, outputs), m/s^2
    rate : float, samples/s
    band : (float, float), Hz
        Of the lines that are kept.
    middle : float, s
    """
    spacing = rate / len(drive)
    low, high = int(np.ceil(band[0] / spacing)), int(np.floor(band[1] / spacing)) + 1
    sent, heard = (
        np.column_stack([(rfft(channel)[low:high] / rate).astype(np.complex64) for channel in signals.T])
        for signals in (drive, response)
    )
    return Spectrum(np.arange(low, high) * spacing, sent, heard, middle)


def stretched(signal: np.ndarray, stretch: float) -> np.ndarray:
    """Read a signal (samples, channels) at `stretch` n, as far as it reaches."""
    count = int((len(signal) - TAPS) / max(stretch, 1.0))
    return _stretched(np.pad(signal, ((BEFORE, TAPS), (0, 0))), BEFORE, stretch, count)


def _stretched(signal: np.ndarray, begin: float, stretch: float, count: int) -> np.ndarray:
    """Read a signal (samples, channels) at `begin` + `stretch` n, by Lagrange polynomials."""
    if stretch == 1:
        return signal[round(begin) : round(begin) + count]
    place = begin + stretch * np.arange(count)
    whole = np.floor(place).astype(int)
    part = place - whole
    nodes = np.arange(TAPS) - BEFORE
    moved = np.zeros((count, signal.shape[1]))
    for node in nodes:
        others = nodes[nodes != node]
        weight = np.prod((part[:, None] - others) / (node - others), axis=1)
        moved += weight[:, None] * signal[whole + node]
    return moved
