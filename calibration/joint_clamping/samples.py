"""Samples kept while a graph ticks: in rows made beforehand, so that a tick does no more than copy."""

from collections.abc import Mapping

import numpy as np

from ctlblocks.recording import Recording

_FIRST = 15_000
"""Rows at first: a minute."""


class Samples:
    """Rows of some signals of a graph.

    Parameters
    ----------
    signals : mapping of str to array, shape (1, width), live
        The graph's own, by name.
    units : mapping of str to str
    """

    def __init__(self, signals: Mapping[str, np.ndarray], units: Mapping[str, str]) -> None:
        self._signals, self._units = dict(signals), units
        self._edges = np.cumsum([0, *(signal.shape[1] for signal in self._signals.values())])
        self._rows = np.empty((_FIRST, int(self._edges[-1])), np.float32)
        self._count = 0

    def __len__(self) -> int:
        """Count the rows."""
        return self._count

    def keep(self) -> None:
        """Add a row: the signals as they are now."""
        if self._count == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        row = self._rows[self._count]
        for place, signal in enumerate(self._signals.values()):
            row[self._edges[place] : self._edges[place + 1]] = signal[0]
        self._count += 1

    def clear(self) -> None:
        """Forget all rows."""
        self._count = 0

    def recording(self, rate: float) -> Recording:
        """Return a copy of the rows; channels are numbered from 1 behind their signal's name."""
        widths = np.diff(self._edges)
        named = [(name, place + 1) for name, width in zip(self._signals, widths, strict=True) for place in range(width)]
        names = tuple(f"{name}_{place}" for name, place in named)
        return Recording(names, tuple(self._units[name] for name, _ in named), rate, self._rows[: self._count].copy())
