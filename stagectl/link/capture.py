"""Every block of a while, each where its number says: what came from the stage while an axis is excited."""

import numpy as np

from stagectl.link.account import Status
from stagectl.wire.messages import AXES, BLOCK

_SIGNALS = ("position", "extension", "voltage")
_MODULUS = 1 << 16
"""Where the counter of blocks begins again."""


class Capture:
    """Filled by the thread that listens, read by another once it is full.

    Parameters
    ----------
    blocks : int
        As many as it keeps, from the first position that comes.
    """

    def __init__(self, blocks: int) -> None:
        self.newest = -1
        self._first: int | None = None
        self._blocks = blocks
        self._samples = {name: np.zeros((blocks * BLOCK, len(AXES))) for name in _SIGNALS}
        self._there = {name: np.zeros(blocks, bool) for name in _SIGNALS}
        self._statuses: list[tuple[int, Status]] = []

    def take(self, name: str, counter: int, block: np.ndarray) -> None:
        """Take a block of "position", "extension" or "voltage", shape (10, 3), m or V."""
        if self._first is None:
            if name != "position":
                return
            self._first = counter
        ahead = (counter - self._first - self.newest) % _MODULUS
        number = self.newest + (ahead if ahead < _MODULUS // 2 else ahead - _MODULUS)
        self.newest = max(self.newest, number)
        if 0 <= number < self._blocks:
            self._samples[name][number * BLOCK : (number + 1) * BLOCK] = block
            self._there[name][number] = True

    def report(self, status: Status) -> None:
        """Take the stage's own account."""
        self._statuses.append((self.newest, status))

    def start(self, first: int, blocks: int) -> int | str:
        """Return in which block the first reference was played, or why that, or the others, cannot be relied on.

        Parameters
        ----------
        first : int, counter of that reference
        blocks : int, references in a row, the last well before the end
        """
        if not self._statuses or self._first is None:
            return "no status came from the stage"
        start = (first + _shift(self._statuses[-1][1]) - self._first) % _MODULUS
        during = [status for newest, status in self._statuses if newest > start]
        if not (self._statuses[-1][0] >= start + blocks and start + blocks <= self._blocks):
            return f"of {blocks} blocks, {max(self.newest - start, 0)} were played"
        if len({_shift(status) for status in during}) != 1 or during[0].underruns != during[-1].underruns:
            return "the stage had to wait for the host"
        for name in ("lost", "late", "garbled"):
            if count := getattr(during[-1], name) - getattr(during[0], name):
                return f"of the blocks to the stage, {count} were {name}"
        return start

    def samples(self, name: str, start: int, blocks: int) -> np.ndarray | str:
        """Return the samples of a signal, shape (10 blocks, 3), m or V, from block `start` on; or what is missing."""
        lost = blocks - int(self._there[name][start : start + blocks].sum())
        if lost:
            return f"of the stage's blocks of {name}, {lost} were lost"
        found: np.ndarray = self._samples[name][start * BLOCK : (start + blocks) * BLOCK]
        return found


def _shift(status: Status) -> int:
    """Return by how much the number of a block is more than the counter of the reference played in it."""
    return (status.block - 1 - status.reference + status.waiting) % _MODULUS
