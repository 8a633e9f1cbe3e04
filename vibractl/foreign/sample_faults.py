"""What is wrong with the samples of a recording, followed block by block: clipping, dropouts, dead channels."""

from dataclasses import dataclass, field

import numpy as np

from vibractl.capture import FULL_SCALE

SHORTEST_CLIP, SHORTEST_DROPOUT = 3, 8
"""Equal samples in a row."""
REACH = 512
"""Samples to each side of equal ones, at most, that must move."""
MOVES = 16.0
"""Steps of the converter that they move by, at least: around a peak of a smooth signal, where samples are equal as
well, they move by 8."""
CLIPS = 2
"""Times that a channel must stay at its largest or smallest value, to be clipped below full scale."""
LOOKED_AT = 4096
"""Samples of a block from which the step of the converter is told, once it is known about."""
TOLD = 10_000
"""Faults of a channel that are kept."""


@dataclass(frozen=True)
class SampleFault:
    """Samples of a channel that are no measurement.

    Parameters
    ----------
    kind : "clipped" or "dropout"
    channel : int
        Column.
    first, end : int, samples
    value : float, any unit
    """

    kind: str
    channel: int
    first: int
    end: int
    value: float


@dataclass
class _Extreme:
    """A channel's largest or smallest value so far, and where it has stayed there."""

    value: float = -np.inf
    runs: list[tuple[int, int]] = field(default_factory=list)

    def follow(self, starts: np.ndarray, ends: np.ndarray, values: np.ndarray, largest: float) -> None:
        """Take runs of equal samples that stand out, and the largest value there was beside them."""
        if largest > self.value:
            self.value, self.runs = largest, []
        at = values >= self.value
        room = TOLD - len(self.runs)
        self.runs += list(zip(starts[at].tolist(), ends[at].tolist(), strict=True))[:room]


class SampleFaults:
    """Follows a recording.

    Parameters
    ----------
    full_scale : array, shape (channels,), each one's unit
        The largest size that a channel can have; infinite where that is not known.
    """

    def __init__(self, full_scale: np.ndarray) -> None:
        self._full_scale, width = full_scale, len(full_scale)
        self._known, self._origin, self._judged = np.zeros((width, 0)), 0, 0
        self._open = np.zeros(width, dtype=int)
        """Where the equal samples began that the known ones begin with."""
        self._step = np.full(width, np.inf)
        self._low, self._high = np.full(width, np.inf), np.full(width, -np.inf)
        self._extremes = [(_Extreme(), _Extreme()) for _ in range(width)]
        self._found: list[SampleFault] = []
        self._kept = {kind: np.zeros(width, dtype=int) for kind in ("clipped", "dropout")}

    def follow(self, block: np.ndarray) -> None:
        """Take the next block (samples, channels), any unit."""
        fresh = np.ascontiguousarray(block.T)
        self._known = np.concatenate((self._known, fresh), axis=1)
        np.minimum(self._low, fresh.min(axis=1), out=self._low)
        np.maximum(self._high, fresh.max(axis=1), out=self._high)
        is_known = np.isfinite(self._step).all()
        steps = np.abs(np.diff(fresh[:, :LOOKED_AT] if is_known else fresh))
        np.minimum(self._step, np.where(steps > 0, steps, np.inf).min(axis=1, initial=np.inf), out=self._step)
        self._judge(self._known.shape[1] - REACH)
        gone = max(self._known.shape[1] - 3 * REACH, 0)
        for channel in range(len(self._open)):
            self._open[channel] = self._began(channel, gone)
        self._known, self._origin = self._known[:, gone:].copy(), self._origin + gone

    def end(self) -> list[SampleFault]:
        """Return all that was found."""
        self._judge(self._known.shape[1])
        found = list(self._found)
        for channel, both in enumerate(self._extremes):
            for sign, extreme in zip((1.0, -1.0), both, strict=True):
                if len(extreme.runs) >= CLIPS:
                    value = sign * extreme.value
                    found = [each for each in found if (each.channel, each.value) != (channel, value)]
                    found += [SampleFault("clipped", channel, *run, value) for run in extreme.runs]
        return sorted(found, key=lambda each: (each.first, each.channel))

    @property
    def dead(self) -> np.ndarray:
        """Which channels have one value throughout, (channels,) of bool."""
        dead: np.ndarray = self._low == self._high
        return dead

    def _began(self, channel: int, place: int) -> int:
        """Return where, in the recording, the equal samples began that one of the known belongs to."""
        values = self._known[channel, : place + 1]
        if len(values) > 1 and values[-1] != values[-2]:
            return self._origin + place
        other = np.flatnonzero(values != values[-1])
        return self._origin + int(other[-1]) + 1 if len(other) else int(self._open[channel])

    def _judge(self, until: int) -> None:
        """Look at what ends before a place in the known samples and was not looked at."""
        since, self._judged = self._judged - self._origin, self._origin + max(until, 0)
        if until <= max(since, 0):
            return
        for channel, signal in enumerate(self._known):
            limit = FULL_SCALE * self._full_scale[channel]
            if max(self._high[channel], -self._low[channel]) >= limit:
                full = np.flatnonzero(np.abs(signal[max(since, 0) : until]) >= limit)
                for first, end in zip(*_runs(full + max(since, 0), 0), strict=True):
                    self._keep("clipped", channel, int(first), int(end))
            starts, ends = _runs(np.flatnonzero(signal[1:] == signal[:-1]), 1)
            chosen = (ends > since) & (ends <= until) & (ends - starts >= SHORTEST_CLIP)
            self._judge_runs(channel, signal, starts[chosen], ends[chosen])

    def _judge_runs(self, channel: int, signal: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> None:
        """Look at runs of equal samples: whether the signal moves on both sides, as that of a sensor does."""
        reach = np.minimum(ends - starts, REACH)
        moves = np.ones(len(starts), dtype=bool)
        for side, edge in ((-1, starts), (1, ends - 1)):
            far = [np.clip(edge + side * part, 0, len(signal) - 1) for part in (reach, -(-reach // 2))]
            away = np.max([np.abs(signal[each] - signal[edge]) for each in far], axis=0)
            moves &= (away > MOVES * self._step[channel]) | ((edge == 0) & (self._origin > 0))
        values, largest = signal[starts], (signal.max(), -signal.min())
        for sign, extreme, most in zip((1.0, -1.0), self._extremes[channel], largest, strict=True):
            extreme.follow(self._origin + starts[moves], self._origin + ends[moves], sign * values[moves], float(most))
        long = moves & (ends - starts >= SHORTEST_DROPOUT)
        for first, end in zip(starts[long], ends[long], strict=True):
            self._keep("dropout", channel, int(first), int(end))

    def _keep(self, kind: str, channel: int, first: int, end: int) -> None:
        began = int(self._open[channel]) if first == 0 else self._origin + first
        self._kept[kind][channel] += 1
        if self._kept[kind][channel] <= TOLD and began > 0:
            value = float(self._known[channel, first])
            self._found.append(SampleFault(kind, channel, began, self._origin + end, value))


def _runs(places: np.ndarray, more: int) -> tuple[np.ndarray, np.ndarray]:
    """Return starts and ends of runs of consecutive places, `more` behind each."""
    breaks = np.flatnonzero(np.diff(places) > 1)
    if not len(places):
        return places, places
    ends: np.ndarray = places[np.concatenate((breaks, [-1]))] + 1 + more
    starts: np.ndarray = places[np.concatenate(([0], breaks + 1))]
    return starts, ends
