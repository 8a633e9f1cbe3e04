"""The compiled sums of products of a record's windows, by their block Hankel structure."""

import numpy as np

from rigkit.compiled import njit


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def _lag_products(signals: np.ndarray, start: int, stop: int, length: int, products: np.ndarray) -> None:
    """Write the sums over t of z[t] z[t + lag]' into products, shape (length, width, width)."""
    width = signals.shape[0]
    for late in range(width):
        for lag in range(length):
            shifted = signals[late, start + lag : stop + lag]
            for early in range(width):
                still = signals[early, start:stop]
                total = 0.0
                for t in range(stop - start):
                    total += still[t] * shifted[t]
                products[lag, early, late] = total


@njit(cache=True, nogil=True)
def window_products(signals: np.ndarray, start: int, stop: int, length: int, result: np.ndarray) -> None:
    """Add the sum of W W' over the windows W that begin at start, ..., stop - 1, upper triangle only.

    `signals` has shape (width, samples); a window is `length` samples of all signals, time first.  The sums for
    samples i + 1 and j + 1 of a window are those for i and j, but for the first and the last window.
    """
    width = signals.shape[0]
    products = np.empty((length, width, width))
    _lag_products(signals, start, stop, length, products)
    current = products.copy()
    for row in range(length):
        for column in range(row, length):
            for early in range(width):
                for late in range(width):
                    result[row * width + early, column * width + late] += current[column - row, early, late]
        for lag in range(length - row - 1):
            for early in range(width):
                leaving, entering = signals[early, start + row], signals[early, stop + row]
                for late in range(width):
                    current[lag, early, late] += (
                        entering * signals[late, stop + row + lag] - leaving * signals[late, start + row + lag]
                    )
