"""Shots cut out of recordings, one at a time: drive and response beside each other, as long as a shot."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vibractl.foreign.estimate import Estimate
from vibractl.foreign.import_plan import FoundShot, Scanned
from vibractl.foreign.near import moved
from vibractl.learner import Timeline

MARGIN = 64
"""Samples beside a shot that is moved by parts of a sample, for the splines."""


@dataclass(frozen=True, eq=False)
class CutShot:
    """A shot as it is kept.

    Parameters
    ----------
    found : FoundShot
    drive : array, shape (samples, drives), V
    response : array, shape (samples, responses), m/s^2
    """

    found: FoundShot
    drive: np.ndarray
    response: np.ndarray


class _Rows:
    """Rows of a recording that is read once, silence where it has none."""

    def __init__(self, blocks: Iterator[np.ndarray], width: int) -> None:
        self._blocks, self._known, self._origin = blocks, [np.zeros((0, width))], 0

    def rows(self, first: int, end: int) -> np.ndarray:
        """Return rows (end - first, columns); what lies before `first` is forgotten."""
        while self._origin + len(self._known[0]) <= first and len(self._known) > 1:
            self._origin += len(self._known.pop(0))
        reached = self._origin + sum(map(len, self._known))
        while reached < end and (block := next(self._blocks, None)) is not None:
            self._known.append(block)
            reached += len(block)
            if reached <= first:
                self._origin, self._known = reached, [block[:0]]
        known = np.concatenate(self._known)
        found = np.zeros((end - first, known.shape[1]))
        low, high = max(first, self._origin), min(end, self._origin + len(known))
        if high > low:
            found[low - first : high - first] = known[low - self._origin : high - self._origin]
        return found


def cut_shots(scanned: Scanned, shot: Timeline, correction: Estimate | None) -> Iterator[CutShot]:
    """Read a recording again and cut its shots out.

    Parameters
    ----------
    scanned : Scanned
    shot : Timeline
    correction : Estimate or None, ppm
        By how much the recorder's clock is faster, to be taken out along with parts of a sample.
    """
    recorded = scanned.recorded
    rows = _Rows(recorded.blocks(), len(recorded.full_scale))
    for found in scanned.shots:
        response, drive = found.placed.response - shot.lead, found.placed.drive - shot.lead
        drift = 0.0 if correction is None else 1e-6 * correction.value
        margin = 0 if correction is None else MARGIN + round(abs(drift) * shot.total)
        both = (response, drive) if recorded.is_beside else (response,)
        first, end = min(both) - margin, max(both) + shot.total + margin
        stretch = rows.rows(first, end)
        heard = stretch[response - margin - first :][: shot.total + 2 * margin, recorded.heard]
        if correction is not None:
            middle = shot.lead + (shot.frames - 1) / 2
            at = middle + (np.arange(shot.total) - middle) * (1 + drift) + found.placed.fraction
            heard = moved(heard, margin + at)
        if recorded.wanted is None:
            played = stretch[drive - first :][: shot.total, recorded.played]
        else:
            played = _Rows(iter([recorded.wanted]), recorded.widths[0]).rows(drive, drive + shot.total)
        yield CutShot(found, played, heard)
