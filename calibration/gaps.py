"""Records cut where samples are missing, so that what is whole can be used."""

import warnings
from collections.abc import Sequence

import numpy as np

from calibration.stretches import stretches

ENOUGH = 160
"""Samples beyond which a longer stretch is worth no more than its samples: four horizons of the usual length."""


def without_gaps(
    drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], shortest: int | None = None
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return the stretches of records in which no sample is missing, each as a record of its own.

    What is left out is said in a warning.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
        Not finite where a sample is missing.
    responses : sequence of arrays, each of shape (N, p), any unit
    shortest : int, samples, optional
        What is shorter is left out too.  Where not given, as long as leaves most: the sum of what is kept times the
        shortest of it, of which `ENOUGH` are enough.

    Returns
    -------
    drives, responses : lists of arrays, shapes (n, m) and (n, p)

    Raises
    ------
    ValueError : no stretch is that long.

    Examples
    --------
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore")
    ...     found, _ = without_gaps([np.arange(9.0)[:, None]], [np.array([[0, 0, 0, 0, np.nan, 0, 0, 0, 0.0]]).T], 3)
    >>> [part.ravel().tolist() for part in found]
    [[0.0, 1.0, 2.0, 3.0], [5.0, 6.0, 7.0, 8.0]]
    """
    pairs = list(zip(drives, responses, strict=True))
    whole = [np.isfinite(drive).all(axis=1) & np.isfinite(response).all(axis=1) for drive, response in pairs]
    missing = sum(int(np.sum(~present)) for present in whole)
    if not missing:
        return list(drives), list(responses)
    between = [
        (drive[first:last], response[first:last])
        for (drive, response), present in zip(pairs, whole, strict=True)
        for first, last in stretches(present)
    ]
    least = _best_of([len(drive) for drive, _ in between]) if shortest is None else shortest
    found = [(drive, response) for drive, response in between if len(drive) >= least]
    if not found:
        raise ValueError(f"{missing} samples are missing, and between them there is no stretch of {least} samples")
    kept, samples = sum(len(drive) for drive, _ in found), sum(len(present) for present in whole)
    warnings.warn(
        f"{missing} of {samples} samples are missing: {kept} in {len(found)} stretch{'es' * (len(found) > 1)} are used",
        stacklevel=3,
    )
    return [drive for drive, _ in found], [response for _, response in found]


def _best_of(lengths: list[int]) -> int:
    """Return the least length that is worth keeping."""
    worth = {length: sum(each for each in lengths if each >= length) * min(length, ENOUGH) for length in lengths}
    return max(worth, key=lambda length: worth[length], default=1)
