"""Records as identification takes them: without their mean, scaled to like size."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from calibration.subspace.drift import without_slow

_STILL = 1e-12
"""Spread re the largest value below which there is rounding alone."""

Detrend = Literal["mean", "record", "linear", "slow", "none"]


@dataclass(frozen=True)
class Signals:
    """Records of inputs and outputs about an operating point, in units of their own spread.

    Parameters
    ----------
    drives : list of arrays, each of shape (N, m), 1
    responses : list of arrays, each of shape (N, p), 1
    input_offset, output_offset : arrays, shapes (m,) and (p,), the inputs' and the outputs' units
        What was taken away from every record.
    input_scale, output_scale : arrays, shapes (m,) and (p,), the inputs' and the outputs' units
        What one means.
    """

    drives: list[np.ndarray]
    responses: list[np.ndarray]
    input_offset: np.ndarray
    output_offset: np.ndarray
    input_scale: np.ndarray
    output_scale: np.ndarray

    @property
    def joined(self) -> list[np.ndarray]:
        """Inputs above outputs: arrays of shape (m + p, N), contiguous."""
        both = zip(self.drives, self.responses, strict=True)
        return [np.ascontiguousarray(np.concatenate(pair, axis=1).T) for pair in both]

    @property
    def samples(self) -> int:
        """In all records."""
        return sum(len(drive) for drive in self.drives)


def levelled(records: Sequence[np.ndarray], detrend: Detrend) -> list[np.ndarray]:
    """Return records without a mean, a line or slow swings of their own, about the mean over all of them.

    Parameters
    ----------
    records : sequence of arrays, each of shape (N, width), any unit
    detrend : "mean", "record", "linear", "slow" or "none"

    Raises
    ------
    ValueError : another word.
    """
    if detrend not in get_args(Detrend):
        raise ValueError(f"detrend is {detrend!r}, must be one of {', '.join(get_args(Detrend))}")
    if detrend in ("mean", "none"):
        return list(records)
    whole = np.concatenate(records).mean(axis=0)
    if detrend == "slow":
        return [whole + without_slow(record) for record in records]
    return [whole + _without_line(record, detrend == "linear") for record in records]


def _without_line(record: np.ndarray, has_slope: bool) -> np.ndarray:
    """Return a record without its mean, and without its slope as well if wanted."""
    left: np.ndarray = record - record.mean(axis=0)
    if has_slope:
        time = np.arange(len(record)) - (len(record) - 1) / 2
        left -= np.outer(time, time @ left / (time @ time))
    return left


def signals(drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], has_mean: bool) -> Signals:
    """Take away what records have in common, and scale them.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), the inputs' units
    responses : sequence of arrays, each of shape (N, p), the outputs' units
    has_mean : bool
        Whether the mean over all records is the operating point, or zero is.

    Raises
    ------
    ValueError : a signal that never changes.
    """
    sides = []
    for name, records in (("input", drives), ("output", responses)):
        whole = np.concatenate(records)
        offset = whole.mean(axis=0) if has_mean else np.zeros(whole.shape[1])
        spread = np.sqrt(np.mean((whole - offset) ** 2, axis=0))
        if not np.all(spread > _STILL * np.abs(whole).max(axis=0)):
            raise ValueError(f"{name} {int(np.argmin(spread)) + 1} never changes, nothing can be identified from it")
        sides.append(([(record - offset) / spread for record in records], offset, spread))
    (driven, low, small), (measured, high, large) = sides
    return Signals(driven, measured, low, high, small, large)
