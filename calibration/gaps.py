"""Records cut where samples are missing, so that what is whole can be used."""

from collections.abc import Sequence

import numpy as np

from calibration.stretches import stretches
from calibration.warned import warn

ENOUGH = 160
"""Samples beyond which a longer stretch is worth no more than its samples: four horizons of the usual length."""
STILL, CHANCE, MOVES = 2, 1e-6, 0.1
"""Samples in which every channel repeats its last value, from where on a logger stood still; probability of as many one
after another by chance; how much of the usual change from sample to sample comes before it and after."""
FEW, RARE = 5, 0.005
"""Times that a logger may stand still in any record, and of all samples: more often it is how the signals are made."""


def without_gaps(
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    shortest: int | None = None,
    at_least: int = 1,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return the stretches of records in which no sample is missing, each as a record of its own.

    Missing as well are those at which a logger stood still and repeated all channels; see `held`.  What is left out is
    said in a warning.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
        Not finite where a sample is missing.
    responses : sequence of arrays, each of shape (N, p), any unit
    shortest : int, samples, optional
        What is shorter is left out too.  Where not given, as long as leaves most: the sum of what is kept times the
        shortest of it, of which `ENOUGH` are enough.
    at_least : int, samples, optional
        And no shorter than this.

    Returns
    -------
    drives, responses : lists of arrays, shapes (n, m) and (n, p)

    Raises
    ------
    ValueError : no stretch is that long.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore")
    ...     found, _ = without_gaps([np.arange(9.0)[:, None]], [np.array([[0, 0, 0, 0, np.nan, 0, 0, 0, 0.0]]).T], 3)
    >>> [part.ravel().tolist() for part in found]
    [[0.0, 1.0, 2.0, 3.0], [5.0, 6.0, 7.0, 8.0]]
    """
    pairs = list(zip(drives, responses, strict=True))
    still = [held(drive, response) for drive, response in pairs]
    whole = [
        np.isfinite(drive).all(axis=1) & np.isfinite(response).all(axis=1) & ~stands
        for (drive, response), stands in zip(pairs, still, strict=True)
    ]
    missing, repeated = (sum(int(np.sum(each)) for each in of) for of in ([~present for present in whole], still))
    if not missing:
        return list(drives), list(responses)
    between = [
        (drive[first:last], response[first:last])
        for (drive, response), present in zip(pairs, whole, strict=True)
        for first, last in stretches(present)
    ]
    lengths = [len(drive) for drive, _ in between if len(drive) >= at_least]
    least = _best_of(lengths, at_least) if shortest is None else max(shortest, at_least)
    found = [(drive, response) for drive, response in between if len(drive) >= least]
    if not found:
        raise ValueError(f"{missing} samples are missing, and between them there is no stretch of {least} samples")
    kept, samples = sum(len(drive) for drive, _ in found), sum(len(present) for present in whole)
    missed = f"{missing} of {samples} samples {'are' if missing > 1 else 'is'} missing{_and_held(repeated)}"
    warn(f"{missed}: {kept} in {len(found)} stretch{'es' * (len(found) > 1)} are used")
    return [drive for drive, _ in found], [response for _, response in found]


def held(drive: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Return at which samples a logger stood still: all channels repeat their last value, amid signals that move.

    Signals at rest are none: they are so at the ends of a record, or come to rest before.  Coarse ones repeat
    themselves by chance: as long as that explains it, and where it is often, signals are taken as they are.

    Parameters
    ----------
    drive : array, shape (N, m), any unit
    response : array, shape (N, p), any unit

    Returns
    -------
    array of bool, shape (N,)

    Examples
    --------
    >>> u, y = np.random.default_rng(1).standard_normal((2, 100, 1))
    >>> u[50:60], y[50:60] = u[49], y[49]
    >>> np.flatnonzero(held(u, y))[[0, -1]].tolist()
    [50, 59]
    """
    both = np.hstack([drive, response])
    same = np.append(False, (both[1:] == both[:-1]).all(axis=1))[: len(both)]
    with np.errstate(invalid="ignore"):
        change = np.abs(np.diff(response, axis=0, prepend=response[:1]))
    known = ~same[:, None] & np.isfinite(change)
    usual = [np.median(of[where]) if where.any() else np.inf for of, where in zip(change.T, known.T, strict=True)]
    missing = ~np.isfinite(both).all(axis=1)  # nobody knows what the signals did
    moves = ~same & ~missing & (change >= MOVES * np.array(usual)).any(axis=1)
    every = list(stretches(same))
    runs = [
        (first, last)
        for first, last in every
        if last - first >= STILL and first > 1 and last < len(both)
        if moves[first - 1] and (moves[last] or missing[last]) or missing[first - 2] and moves[last]
    ]
    stands = np.zeros(len(both), bool)
    if not runs or len(runs) > max(FEW, RARE * len(both)):
        return stands
    rests = [(first, last) for first, last in every if first == 1 or last == len(both)]
    by_chance = (np.sum(same) - sum(last - first for first, last in (*runs, *rests))) / len(both)
    for first, last in runs:
        stands[first:last] = len(both) * by_chance ** (last - first) < CHANCE
    return stands


def _and_held(samples: int) -> str:
    return f", {samples} of them repeated by a logger that stood still" if samples else ""


def _best_of(lengths: list[int], otherwise: int) -> int:
    """Return the least length that is worth keeping."""
    worth = {length: sum(each for each in lengths if each >= length) * min(length, ENOUGH) for length in lengths}
    return max(worth, key=lambda length: worth[length], default=otherwise)
