"""Records as identification takes them: checked, without their mean, scaled to like size."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

Detrend = Literal["mean", "none"]


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


def as_records(signal: np.ndarray | Sequence[np.ndarray], name: str) -> list[np.ndarray]:
    """Return one or more records as a list of arrays, each of shape (N, width), all of one width.

    Parameters
    ----------
    signal : array, shape (N, width), or a sequence of such, any unit
    name : str
        For the errors.

    Raises
    ------
    ValueError : another shape, or a value that is not finite.
    """
    records = [signal] if isinstance(signal, np.ndarray) and signal.ndim != 3 else list(signal)
    if not records:
        raise ValueError(f"there is no record of {name}")
    arrays = [np.asarray(record, dtype=float) for record in records]
    for number, array in enumerate(arrays):
        if array.ndim != 2 or array.shape[1] != arrays[0].shape[-1] or not array.shape[1]:
            raise ValueError(
                f"{name} of record {number + 1} has shape {array.shape}, must be (N, width), all of one width"
            )
        if not np.isfinite(array).all():
            sample, channel = np.argwhere(~np.isfinite(array))[0]
            raise ValueError(f"{name} {channel + 1} of record {number + 1} is not finite at sample {sample}")
    return arrays


def signals(
    drive: np.ndarray | Sequence[np.ndarray], response: np.ndarray | Sequence[np.ndarray], detrend: Detrend
) -> Signals:
    """Check records and scale them.

    Parameters
    ----------
    drive : array, shape (N, m), or a sequence of such, the inputs' units
    response : array, shape (N, p), or a sequence of such, the outputs' units
    detrend : "mean" or "none"
        Whether the mean over all records is the operating point, or zero is.

    Raises
    ------
    ValueError : records that do not belong together, a value that is not finite, a signal that never changes.
    """
    if detrend not in ("mean", "none"):
        raise ValueError(f"detrend is {detrend!r}, must be 'mean' or 'none'")
    drives, responses = as_records(drive, "input"), as_records(response, "output")
    if [len(each) for each in drives] != [len(each) for each in responses]:
        raise ValueError(
            f"inputs have {[len(each) for each in drives]} samples and outputs {[len(each) for each in responses]}, "
            "must be as many in each record"
        )
    sides = []
    for name, records in (("input", drives), ("output", responses)):
        whole = np.concatenate(records)
        offset = whole.mean(axis=0) if detrend == "mean" else np.zeros(whole.shape[1])
        spread = np.sqrt(np.mean((whole - offset) ** 2, axis=0))
        if not np.all(spread > 0):
            raise ValueError(f"{name} {int(np.argmin(spread)) + 1} never changes, nothing can be identified from it")
        sides.append(([(record - offset) / spread for record in records], offset, spread))
    (driven, low, small), (measured, high, large) = sides
    return Signals(driven, measured, low, high, small, large)
