"""Where in a recording shots are: streamed at a lower rate, found by correlation with what is known of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from vibractl.foreign.search import Likeness

LIKE = 0.5
"""Least correlation: a shot of which three quarters of the power is something else is found."""
APART = 0.9
"""Of a reference's length, that shots are apart at least."""
AT_ONCE = 30.0
"""s that are searched at once."""


@dataclass(frozen=True, eq=False)
class Probe:
    """Something that is known of each shot.

    Parameters
    ----------
    template : array, shape (frames, channels), any unit
        While the reference lasts.
    columns : tuple of int
        Of the recording, that it is like.
    """

    template: np.ndarray
    columns: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Sighting:
    """A shot that was found.

    Parameters
    ----------
    place : int, slow samples
        Where in the recording the reference begins, about.
    likeness : float, 0 to 1
    stretch : array, shape (samples, columns)
        The recording around it, silence where it has none.
    origin : int, slow samples
        Where in the recording the stretch begins; may be negative.
    """

    place: int
    likeness: float
    stretch: np.ndarray
    origin: int

    @property
    def at(self) -> int:
        """Where in the stretch the reference begins, about."""
        return self.place - self.origin


class ShotSearch:
    """Follows a recording and gives its shots, with memory for some of them.

    Parameters
    ----------
    probes : sequence of Probe, all of one length
    rate : float, slow samples/s
    before, after : int, slow samples
        Of the recording, around the frames of a shot.
    """

    def __init__(self, probes: Sequence[Probe], rate: float, before: int, after: int) -> None:
        self._probes, self._frames = probes, len(probes[0].template)
        self._likeness = [Likeness(each.template) for each in probes]
        self._before, self._after = before, after
        self._enough = round(AT_ONCE * rate) + before + after + 3 * self._frames
        self._known = np.zeros((0, 0))
        self._parts: list[np.ndarray] = []
        self._origin, self._searched, self._waiting = 0, 0, 0
        self.best = 0.0
        """The largest correlation anywhere."""

    def follow(self, slow: np.ndarray) -> Iterator[Sighting]:
        """Take what comes next, (slow samples, columns), any unit, and give the shots that are whole now."""
        self._parts.append(slow)
        self._waiting += len(slow)
        if len(self._known) + self._waiting >= self._enough:
            self._join()
            settled = self._origin + len(self._known) - self._after - 2 * self._frames
            yield from self._found(settled)
            self._forget(settled)

    def end(self) -> Iterator[Sighting]:
        """Give the shots that are left."""
        self._join()
        yield from self._found(self._origin + len(self._known))

    def _join(self) -> None:
        parts = [self._known, *self._parts] if self._known.size else self._parts
        self._known, self._parts, self._waiting = np.concatenate(parts), [], 0

    def _forget(self, settled: int) -> None:
        self._searched = max(self._searched, settled)
        gone = max(self._searched - self._before - self._frames - self._origin, 0)
        self._known, self._origin = self._known[gone:].copy(), self._origin + gone

    def _found(self, settled: int) -> Iterator[Sighting]:
        """Give the shots that begin before a place and were not given."""
        if len(self._known) < self._frames:
            return
        every = zip(self._likeness, self._probes, strict=True)
        like = np.max([one.everywhere(self._known[:, each.columns]) for one, each in every], axis=0)
        self.best = max(self.best, float(like.max()))
        apart = max(1, round(APART * self._frames))
        peaks, _ = find_peaks(np.concatenate(([0.0], like, [0.0])), height=LIKE, distance=apart)
        for peak in peaks - 1:
            place = self._origin + int(peak)
            if self._searched <= place < settled:
                self._searched = place + apart
                yield Sighting(place, float(like[peak]), *self._stretch(place))

    def _stretch(self, place: int) -> tuple[np.ndarray, int]:
        origin, end = place - self._before, place + self._frames + self._after
        stretch = np.zeros((end - origin, self._known.shape[1]))
        first, last = max(origin, self._origin), min(end, self._origin + len(self._known))
        stretch[first - origin : last - origin] = self._known[first - self._origin : last - self._origin]
        return stretch, origin
