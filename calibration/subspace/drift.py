"""Records without what is so slow that sensors may have drifted by it."""

import numpy as np

HALVES, EACH = 10, 50
"""Half swings over a record, the fastest that are slow; but so many samples at least for each of what is taken away."""


def without_slow(record: np.ndarray) -> np.ndarray:
    """Return a record without its mean, its slope and swings of up to `HALVES` half periods over its length.

    Parameters
    ----------
    record : array, shape (N, width), any unit
    """
    samples = len(record)
    time = (np.arange(samples) + 0.5) / samples
    half = np.arange(1, min(HALVES, max(0, samples // EACH - 2)) + 1)
    shapes = np.concatenate([np.ones((samples, 1)), time[:, None], np.cos(np.pi * half * time[:, None])], axis=1)
    basis = np.linalg.qr(shapes)[0]
    left: np.ndarray = record - basis @ (basis.T @ record)
    return left
