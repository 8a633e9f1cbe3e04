"""The prefilters of all axes as one block."""

from collections.abc import Sequence

import numpy as np

from ctlblocks.block import Block, Port
from stagectl.stage import prefilter_kernel as kernel
from stagectl.stage.prefilter import Prefilter


class PrefilteredReference(Block):
    """References as `Prefilter` makes them, from where they are at first; an axis without one gets its own.

    A reference that is no number comes out as none, and is not remembered.

    Ports, one wide an axis: `reference` (m) in; `filtered` (m) out.

    Parameters
    ----------
    filters : sequence of Prefilter or None
        One of each an axis.
    """

    def __init__(self, filters: Sequence[Prefilter | None]) -> None:
        axes = len(filters)
        self.inputs, self.outputs = (Port("reference", "m", axes),), (Port("filtered", "m", axes),)
        self._take(filters)

    def _take(self, filters: Sequence[Prefilter | None]) -> None:
        axes = len(filters)
        lengths = [1 if each is None else len(each.taps) for each in filters]
        self._taps = np.zeros((axes, max(lengths, default=1)))
        self._filters = np.zeros(axes, kernel.FILTER)
        self._filters["count"] = lengths
        self._filters["spacing"] = [1 if each is None else each.spacing for each in filters]
        for axis, each in enumerate(filters):
            self._taps[axis, : lengths[axis]] = 1.0 if each is None else each.taps
        self._longest = int((self._filters["spacing"] * (self._filters["count"] + 1)).max(initial=1))

    def change(self, filters: Sequence[Prefilter | None]) -> None:
        """Take other filters (between ticks), which begin with the next reference.

        Parameters
        ----------
        filters : sequence of Prefilter or None
            One of each an axis.
        """
        self._take(filters)
        self._forget()

    def prepare(self, rate: float, frames: int) -> None:
        """Remember nothing."""
        self._forget()

    def _forget(self) -> None:
        axes = len(self._taps)
        self._lines = np.zeros((self._longest, axes)), np.zeros((self._longest, axes))
        self._at, self._filters["has_begun"] = np.zeros(1, np.int64), False

    def process(self, reference: np.ndarray, filtered: np.ndarray) -> None:
        """Filter one frame."""
        kernel.run(reference, filtered, self._filters, self._taps, self._lines, self._at)
