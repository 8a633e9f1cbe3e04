"""Stretches of lines, bins or samples that something is true of."""

from collections.abc import Iterator

import numpy as np


def stretches(which: np.ndarray) -> Iterator[tuple[int, int]]:
    """Go through the stretches that are true: the first place, and the first behind it.

    Parameters
    ----------
    which : array of bool, shape (places,)

    Examples
    --------
    >>> list(stretches(np.array([True, False, True, True])))
    [(0, 1), (2, 4)]
    """
    ends = np.flatnonzero(np.diff(np.concatenate(([0], which.astype(int), [0]))))
    yield from ((int(first), int(last)) for first, last in ends.reshape(-1, 2))
