"""Windows of past and future samples, compressed into one triangle: all that a subspace method needs of N samples."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError, cholesky, qr

from calibration.subspace import window_kernel

_DEPENDENT = 1e-9
"""Where less than this part of a row's power is its own, rounding of sums of products counts: QR takes over."""
_CHUNK = 4
"""Windows in one QR step, in heights of the triangle."""


@dataclass(frozen=True)
class Layout:
    """How a triangle's rows are made of a window: future inputs, past inputs and outputs, future outputs.

    Parameters
    ----------
    past, future : int, samples
        Horizons.
    inputs, outputs : int
    """

    past: int
    future: int
    inputs: int
    outputs: int

    @property
    def length(self) -> int:
        """Samples of a window."""
        return self.past + self.future

    @property
    def largest_order(self) -> int:
        """States that the horizons can tell apart."""
        return min((self.future - 1) * self.outputs, self.past * (self.inputs + self.outputs))

    @cached_property
    def order(self) -> np.ndarray:
        """Place in a window, as it comes in time, of each row: shape (rows,)."""
        places = np.arange(self.length * (self.inputs + self.outputs)).reshape(self.length, -1)
        later = places[self.past :]
        parts = later[:, : self.inputs], places[: self.past], later[:, self.inputs :]
        return np.concatenate([part.ravel() for part in parts])

    @property
    def parts(self) -> tuple[slice, slice, slice]:
        """Rows of future inputs, past, future outputs."""
        first = self.future * self.inputs
        second = first + self.past * (self.inputs + self.outputs)
        return slice(0, first), slice(first, second), slice(second, len(self.order))

    def within(self, longer: "Layout") -> np.ndarray:
        """Return which rows of longer horizons' windows are those of these, about the same sample: shape (rows,)."""
        width = self.inputs + self.outputs
        row = np.empty(len(longer.order), dtype=int)
        row[longer.order] = np.arange(len(row))
        inside: np.ndarray = row[(longer.past - self.past) * width :][self.order]
        return inside

    def rows(self, start: int, stop: int, channels: slice = slice(None)) -> np.ndarray:
        """Return the rows, shape (count,), of some channels (inputs first) of samples start to stop of a window."""
        row = np.empty(len(self.order), dtype=int)
        row[self.order] = np.arange(len(self.order))
        chosen: np.ndarray = row.reshape(self.length, -1)[start:stop, channels].ravel()
        return chosen


class Windows:
    """All windows of some records, in segments that can be left out one at a time.

    Parameters
    ----------
    records : sequence of arrays, each of shape (inputs + outputs, N), contiguous, of like size, 1
    layout : Layout
    segments : int, or sequence of (record, first, last) of int
        In all, shared out by length, at least one a record; or where the windows of each begin, `last` not among them.
    constant : bool
        Whether a constant is taken out of every row, the same for all records.
    """

    def __init__(
        self,
        records: Sequence[np.ndarray],
        layout: Layout,
        segments: int | Sequence[tuple[int, int, int]],
        constant: bool,
    ) -> None:
        self.layout = layout
        self._records = records
        self._constant = constant
        starts = [record.shape[1] - layout.length + 1 for record in records]
        self._bounds = _shared_out(starts, segments) if isinstance(segments, int) else list(segments)
        self._sizes = np.array([stop - start for _, start, stop in self._bounds])

    @property
    def segments(self) -> int:
        """How many there are."""
        return len(self._bounds)

    def samples(self, segment: int) -> tuple[int, int, int]:
        """Return record, first sample and the one after the last of a segment; they share out all samples."""
        number, start, stop = self._bounds[segment]
        length = self._records[number].shape[1]
        return number, start, length if stop + self.layout.length > length else stop

    def count(self, without: Sequence[int] = ()) -> int:
        """Count the windows, all or without those of some segments."""
        return int(self._sizes.sum() - self._sizes[list(without)].sum())

    def triangle(self, without: Sequence[int] = (), layout: Layout | None = None) -> np.ndarray:
        """Return the lower triangle L, shape (rows, rows), whose L L' is the mean of w w' over the windows w.

        By Cholesky of the sums of products; where signals nearly depend on one
        another (almost no noise, or inputs that excite only a few frequencies) by QR of the windows.

        Parameters
        ----------
        without : sequence of int, optional
            Segments to leave out.
        layout : Layout, optional
            Shorter horizons.
        """
        chosen = ~np.isin(np.arange(self.segments), list(without))
        count = self.count(without)
        rows = (self.layout if layout is None else layout).within(self.layout)
        if self._is_conditioned:
            try:
                sums = self._sums(chosen)[np.ix_(rows, rows)]
                factor: np.ndarray = cholesky(sums / count, lower=True, check_finite=False)
            except LinAlgError:
                pass
            else:
                return factor
        spare = int(self._constant)
        columns = np.concatenate([np.arange(spare), spare + rows])
        stacked = _upper(np.concatenate([self._triangles[segment][:, columns] for segment in np.flatnonzero(chosen)]))
        lower: np.ndarray = stacked[spare:, spare:].T / np.sqrt(count)
        return lower

    def _sums(self, chosen: np.ndarray) -> np.ndarray:
        """Add products over segments, about the mean if a constant is taken out: shape (rows, rows)."""
        sums: np.ndarray = np.tensordot(chosen.astype(float), self._products, axes=1)  # indexing would copy them
        if self._constant:
            total = self._totals[chosen].sum(axis=0)
            sums -= np.outer(total, total) / self._sizes[chosen].sum()
        return sums

    @cached_property
    def _totals(self) -> np.ndarray:
        """Sums of each segment's windows, shape (segments, rows)."""
        running = [np.pad(np.cumsum(record, axis=1), ((0, 0), (1, 0))) for record in self._records]
        places = np.arange(self.layout.length)
        totals = [
            (running[number][:, stop + places] - running[number][:, start + places]).T.ravel()
            for number, start, stop in self._bounds
        ]
        return np.array(totals)[:, self.layout.order]

    @cached_property
    def _products(self) -> np.ndarray:
        """Sums of products over each segment's windows, shape (segments, rows, rows)."""
        order = self.layout.order
        products = np.empty((self.segments, len(order), len(order)))
        for (number, start, stop), arranged in zip(self._bounds, products, strict=True):
            sums = np.zeros_like(arranged)
            window_kernel.window_products(self._records[number], start, stop, self.layout.length, sums)
            sums = np.triu(sums) + np.triu(sums, 1).T
            arranged[:] = sums[order[:, None], order]
        return products

    @cached_property
    def _is_conditioned(self) -> bool:
        sums = self._sums(np.ones(self.segments, dtype=bool))
        try:
            factor = cholesky(sums, lower=True, check_finite=False)
        except LinAlgError:
            return False
        return bool(np.all(np.diag(factor) ** 2 > _DEPENDENT * np.diag(sums)))

    @cached_property
    def _triangles(self) -> list[np.ndarray]:
        """Each segment's windows as an upper triangle, by QR a few at a time."""
        return [self._segment_triangle(*bounds) for bounds in self._bounds]

    def _segment_triangle(self, number: int, start: int, stop: int) -> np.ndarray:
        """Return an upper triangle, with a first row and column more where a constant is taken out."""
        size, length, spare = len(self.layout.order), self.layout.length, int(self._constant)
        inside = np.lib.stride_tricks.sliding_window_view(self._records[number], length, axis=1)
        triangle = np.zeros((0, spare + size))
        for first in range(start, stop, _CHUNK * size):
            part = inside[:, first : min(stop, first + _CHUNK * size)]
            rows = np.ones((part.shape[1], spare + size))
            rows[:, spare:] = part.transpose(1, 2, 0).reshape(part.shape[1], size)[:, self.layout.order]
            triangle = _upper(np.concatenate([triangle, rows]))
        return triangle


def _shared_out(starts: Sequence[int], segments: int) -> list[tuple[int, int, int]]:
    """Share out segments among records by how many windows begin in each."""
    pieces = np.maximum(1, np.round(segments * np.array(starts) / sum(starts))).astype(int)
    edges = [np.linspace(0, count, parts + 1).astype(int) for count, parts in zip(starts, pieces, strict=True)]
    return [
        (number, int(start), int(stop))
        for number, each in enumerate(edges)
        for start, stop in zip(each[:-1], each[1:], strict=True)
    ]


def _upper(rows: np.ndarray) -> np.ndarray:
    """Return R of rows = Q R with no negative diagonal, square."""
    size = rows.shape[1]
    triangle = np.zeros((size, size))
    part = qr(rows, mode="r", overwrite_a=True, check_finite=False)[0][:size]
    triangle[: len(part)] = part
    return triangle * np.where(np.diag(triangle) < 0, -1.0, 1.0)[:, None]
