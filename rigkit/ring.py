"""Samples from one thread to another, without a lock: one writes, one reads, nobody waits."""

import numpy as np


class Ring:
    """The last samples written, as many as `capacity`.

    Parameters
    ----------
    width : int, channels
    capacity : int, samples
    """

    def __init__(self, width: int, capacity: int) -> None:
        self.written = self.taken = 0
        self.refused = 0
        self._capacity = capacity
        self._samples = np.zeros((capacity, width))

    def __len__(self) -> int:
        """Count the samples that wait for the reader."""
        return self.written - self.taken

    @property
    def offered(self) -> int:
        """Samples that the writer has had in all."""
        return self.written + self.refused

    def put(self, block: np.ndarray) -> None:
        """Add samples (the writer); those that find no room are refused, and counted.

        Parameters
        ----------
        block : array, shape (samples, width), any unit
        """
        count = min(len(block), self._capacity - len(self))
        start = self.written % self._capacity
        first = min(count, self._capacity - start)
        self._samples[start : start + first] = block[:first]
        self._samples[: count - first] = block[first:count]
        self.refused += len(block) - count
        self.written += count  # last: from here on the reader sees them

    def take(self, block: np.ndarray) -> int:
        """Fill `block` from its beginning with the oldest samples (the reader); return how many there were.

        Parameters
        ----------
        block : array, shape (samples, width), any unit
        """
        count = min(len(block), len(self))
        start = self.taken % self._capacity
        first = min(count, self._capacity - start)
        block[:first] = self._samples[start : start + first]
        block[first:count] = self._samples[: count - first]
        self.taken += count
        return count

    def skip(self) -> None:
        """Pass over what waits (the reader)."""
        self.taken = self.written
