"""How a signal rises from rest."""

import numpy as np


def rise(samples: int) -> np.ndarray:
    """Return half of a raised cosine from 0 to 1, shape (samples,), 1; backwards it is the fall."""
    up: np.ndarray = 0.5 - 0.5 * np.cos(np.pi * (np.arange(samples) + 0.5) / samples)
    return up
