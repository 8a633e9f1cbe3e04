"""Records cut into blocks that are held out in turn, to choose horizon and order by what was not fitted."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calibration.subspace.estimate import Compressed, compress
from calibration.subspace.realization import Method
from calibration.subspace.signals import Signals
from calibration.subspace.windows import Layout, Windows

FOLDS = 4
ENOUGH = 6000
"""Samples, in all, on which candidates are fitted and judged; correlations are taken of all there are."""

GRID, BANDS = 1024, 16
"""Samples of a spectrum, and bands in which drives are compared."""
FAINT, ALONE = 0.1, 0.5
"""Power re that of a fold below which others have none in a band; part of a fold's power that may lie in such bands."""

Bounds = tuple[int, int, int]
"""Record, first sample, sample after the last."""


@dataclass(frozen=True)
class Part:
    """Records of some folds.

    Parameters
    ----------
    drives : list of arrays, each of shape (N, m), 1
    responses : list of arrays, each of shape (N, p), 1
    """

    drives: list[np.ndarray]
    responses: list[np.ndarray]


class Folds:
    """Parts of records that are held out in turn, with the windows of all the rest.

    Records are dealt out whole where there are enough, and cut into blocks where not.  No window that is used to
    identify has a sample in the part that is held out.

    Parameters
    ----------
    data : Signals
    layout : Layout
        The longest: shorter horizons are read from its products.
    constant : bool
        Whether a constant is taken out of every row.
    """

    def __init__(self, data: Signals, layout: Layout, constant: bool) -> None:
        self._data, self._layout = data, layout
        self.blocks = _blocks([len(drive) for drive in data.drives])
        pieces, self._touched = _pieces(self.blocks, [len(drive) for drive in data.drives], layout.length)
        self._windows = Windows(data.joined, layout, pieces, constant)

    @cached_property
    def are_alike(self) -> bool:
        """Whether what is held out asks nothing that the rest does not tell: not so of a sweep, or of a single step.

        Of the drives' power in a fold, so much lies where the others have some too.  Bands of frequency have like parts
        of all power.
        """
        parts = [self._spectrum(self.held_out(fold)) for fold in range(FOLDS)]
        shares = np.cumsum(np.mean(parts, axis=0), axis=-1)
        edges = (shares * BANDS / shares[..., -1:]).astype(int).clip(max=BANDS - 1)
        for fold, own in enumerate(parts):
            rest = np.mean([each for other, each in enumerate(parts) if other != fold], axis=0)
            for mine, others, band in zip(own, rest, edges, strict=True):
                here, there = (np.bincount(band, power, BANDS) for power in (mine, others))
                if here[there < FAINT * here].sum() > ALONE * here.sum():
                    return False
        return True

    def held_out(self, fold: int | None) -> Part:
        """Return what is held out; all where no fold is named."""
        return self.kept(None) if fold is None else self._part(self._trimmed[fold])

    def kept(self, fold: int | None) -> Part:
        """Return the rest, or all, blocks that follow one another joined."""
        rest = sorted(bounds for other, blocks in enumerate(self._trimmed) if other != fold for bounds in blocks)
        joined: list[Bounds] = []
        for record, first, last in rest:
            if joined and joined[-1][0] == record and joined[-1][2] == first:
                joined[-1] = record, joined[-1][1], last
            else:
                joined.append((record, first, last))
        return self._part(joined)

    def compressed(self, fold: int | None, layout: Layout, method: Method) -> Compressed:
        """Compress all windows, or those that touch nothing of what is held out, with these horizons or the longest."""
        return compress(self._windows, method, () if fold is None else self._touched[fold], layout)

    def _spectrum(self, part: Part) -> np.ndarray:
        """Return the mean power of each drive at frequencies from 0 to half the rate, shape (m, frequencies)."""
        found = [
            np.abs(np.fft.rfft((drive - drive.mean(axis=0)) * np.hanning(len(drive))[:, None], GRID, axis=0)) ** 2
            for whole in part.drives
            for drive in np.array_split(whole, -(-len(whole) // GRID))
        ]
        power: np.ndarray = np.sum(found, axis=0).T
        return power

    @cached_property
    def _trimmed(self) -> list[list[Bounds]]:
        share = min(1.0, ENOUGH / self._data.samples)
        return [
            [(record, first, first + int((last - first) * share)) for record, first, last in blocks]
            for blocks in self.blocks
        ]

    def _part(self, bounds: Sequence[Bounds]) -> Part:
        drives = [self._data.drives[record][first:last] for record, first, last in bounds]
        return Part(drives, [self._data.responses[record][first:last] for record, first, last in bounds])


def _blocks(lengths: Sequence[int]) -> list[list[Bounds]]:
    """Deal out records, or blocks of them, longest first."""
    each = -(-FOLDS // len(lengths))
    cuts = [np.linspace(0, length, each + 1).astype(int) for length in lengths]
    blocks = [
        (record, int(first), int(last))
        for record, edges in enumerate(cuts)
        for first, last in zip(edges[:-1], edges[1:], strict=True)
    ]
    folds: list[list[Bounds]] = [[] for _ in range(FOLDS)]
    for block in sorted(blocks, key=lambda bounds: bounds[1] - bounds[2]):
        min(folds, key=lambda fold: sum(last - first for _, first, last in fold)).append(block)
    return folds


def _pieces(
    blocks: Sequence[Sequence[Bounds]], lengths: Sequence[int], window: int
) -> tuple[list[Bounds], list[tuple[int, ...]]]:
    """Cut the starts of all windows into pieces so that what touches a block is whole pieces; return both."""
    pieces: list[Bounds] = []
    touched: list[list[int]] = [[] for _ in blocks]
    for record, length in enumerate(lengths):
        own = [(first, last, fold) for fold, each in enumerate(blocks) for at, first, last in each if at == record]
        last_start = length - window + 1
        edges = {0, last_start} | {e for first, last, _ in own for e in (first - window + 1, first, last)}
        inside = sorted(edge for edge in edges if 0 <= edge <= last_start)
        for start, stop in zip(inside[:-1], inside[1:], strict=True):
            for first, last, fold in own:
                if start < last and stop - 1 + window > first:
                    touched[fold].append(len(pieces))
            pieces.append((record, start, stop))
    return pieces, [tuple(each) for each in touched]
