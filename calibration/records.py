"""Records of inputs and outputs as people hand them over: one or several, checked before anything is computed."""

from collections.abc import Sequence

import numpy as np


def as_records(
    drive: np.ndarray | Sequence[np.ndarray], response: np.ndarray | Sequence[np.ndarray]
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return inputs and outputs as lists of arrays, record by record of one length, all of one width.

    Parameters
    ----------
    drive : array, shape (N, m), or a sequence of such, any unit
    response : array, shape (N, p), or a sequence of such, any unit

    Returns
    -------
    drives, responses : lists of arrays, shapes (N, m) and (N, p)

    Raises
    ------
    ValueError : another shape, lengths that differ, or a value that is not finite.
    """
    drives, responses = _side(drive, "input"), _side(response, "output")
    if [len(each) for each in drives] != [len(each) for each in responses]:
        raise ValueError(
            f"inputs have {[len(each) for each in drives]} samples and outputs {[len(each) for each in responses]}, "
            "must be as many in each record"
        )
    return drives, responses


def _side(signal: np.ndarray | Sequence[np.ndarray], name: str) -> list[np.ndarray]:
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
