"""How much the inputs excite: of how high an order a system could be told from them."""

from collections.abc import Sequence

import numpy as np

MOST = 40
"""Order of persistent excitation beyond which nobody asks."""
_RANK = 1e-8
"""Power of the weakest combination of lagged inputs, re the mean, below which it is none."""
SAME = 1 - 1e-9
"""Correlation of two inputs that are one signal."""


def persistence(drives: Sequence[np.ndarray]) -> int:
    """Return the order of which inputs excite persistently, `MOST` at most; 0 where one repeats another.

    The largest number of lags of which no combination is always zero: a sum of k sines has 2 k, white noise any.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
        Without their mean.

    Source
    ------
    Ljung 1999, System Identification, 2nd ed., section 13.2.

    Examples
    --------
    >>> persistence([np.sin(0.3 * np.arange(500.0))[:, None]])
    2
    """
    width = drives[0].shape[1]
    if not width:
        return 0
    lags = min(MOST, min(len(drive) for drive in drives) // (2 * width))
    windows = [
        np.lib.stride_tricks.sliding_window_view(drive / np.maximum(drive.std(axis=0), 1e-300), lags, axis=0)
        for drive in drives
    ]
    flat = [each.transpose(0, 2, 1).reshape(len(each), -1) for each in windows]
    flat = [each - each.mean(axis=0) for each in flat]
    products = sum(each.T @ each for each in flat) / sum(len(each) for each in flat)
    for order in range(1, lags + 1):
        part = products[: order * width, : order * width]
        if np.linalg.eigvalsh(part)[0] < _RANK * np.trace(part) / len(part):
            return order - 1
    return int(lags)


def repeated(drives: Sequence[np.ndarray]) -> tuple[int, int] | None:
    """Return two inputs, counted from 0, that are one signal; none where all differ.

    Parameters
    ----------
    drives : sequence of arrays, each of shape (N, m), any unit
    """
    whole = np.concatenate(drives)
    whole = whole - whole.mean(axis=0)
    size = np.linalg.norm(whole, axis=0)
    pairs = np.argwhere(np.triu(np.abs(whole.T @ whole), 1) > SAME * np.outer(size, size))
    return (int(pairs[0, 0]), int(pairs[0, 1])) if len(pairs) else None
