"""The references a stage has still to follow, in m or V from rest: in order, without gaps, and the way back."""

from collections import deque

import numpy as np

from stagectl.wire.messages import AXES, BLOCK, RATE


class ReferenceQueue:
    """Blocks of references waiting for their millisecond.

    Blocks lost on the way are filled by a straight line.  When none is waiting the last sample is held, and the next is
    played once `ahead` are waiting again.

    Parameters
    ----------
    ahead : int, blocks that wait before the first is played, against the host's unsteady timing
    """

    LONGEST = 100
    """Blocks, or four times `ahead`; the oldest beyond are dropped, and counted as lost."""

    def __init__(self, ahead: int) -> None:
        self.lost = self.late = self.underruns = 0
        self._ahead = ahead
        self._blocks: deque[np.ndarray] = deque()
        self._last = np.zeros(len(AXES))
        self._end = np.zeros(len(AXES))
        self._primed = False

    def __len__(self) -> int:
        """Blocks waiting."""
        return len(self._blocks)

    def clear(self, ahead: int) -> None:
        """Forget what waits; the next block starts from mid-travel, once `ahead` blocks wait."""
        self._ahead = ahead
        self._blocks.clear()
        self._last = np.zeros(len(AXES))
        self._end = self._last
        self._primed = False

    def put(self, missing: int, block: np.ndarray) -> None:
        """Add a block.

        Parameters
        ----------
        missing : int, blocks lost before it
        block : array, shape (samples, axes), m from mid-travel
            Ten samples; or one, which is reached along a straight line.
        """
        self.lost += missing
        samples = missing * BLOCK + (BLOCK if len(block) == 1 else 0)
        if samples:
            way = np.linspace(self._end, block[0], samples + 1)[1:]
            self._blocks.extend(way.reshape(-1, BLOCK, len(AXES)))
        if len(block) > 1:
            self._blocks.append(block)
        self._end = block[-1]
        while len(self._blocks) > max(self.LONGEST, 4 * self._ahead):
            self._blocks.popleft()
            self.lost += 1

    def take(self) -> np.ndarray:
        """Return the next block, shape (samples, axes), m from mid-travel."""
        if not self._primed and len(self._blocks) >= max(self._ahead, 1):
            self._primed = True
        if self._primed and self._blocks:
            block = self._blocks.popleft()
            self._last = block[-1]
            return block
        if self._primed:
            self.underruns += 1
            self._primed = False
        return np.tile(self._last, (BLOCK, 1))

    def retreat(self, seconds: float) -> None:
        """Replace what waits by a raised cosine from the last sample played to mid-travel, within `seconds`."""
        blocks = max(round(seconds * RATE / BLOCK), 1)
        phase = np.arange(1, blocks * BLOCK + 1)[:, np.newaxis] / (blocks * BLOCK)
        way = self._last * (0.5 + 0.5 * np.cos(np.pi * phase))
        self._blocks = deque(way.reshape(-1, BLOCK, len(AXES)))
        self._primed = True
