"""How far the workpiece was seen to turn from the orientation in which it was touched off."""

import numpy as np

AVERAGED = 0.1
"""s over which what the tracker sees is averaged: a single sample has more noise than there is turning."""


def turned(orientation: np.ndarray, rate: float, touched: tuple[float, float], milled: tuple[float, float]) -> float:
    """Return the turn from the mean orientation at rest, rad, root mean square of means over `AVERAGED`.

    Parameters
    ----------
    orientation : array, shape (samples, 4), 1
        Unit quaternions w x y z, zeros where nothing was seen.
    rate : float, samples/s
    touched, milled : pair of float, s
        From when to when it rests, and is followed.

    Returns
    -------
    float
        NaN where one of both was not seen.
    """
    rest, followed = (orientation[round(first * rate) : round(last * rate)] for first, last in (touched, milled))
    rest, followed = (each[np.any(each != 0.0, axis=1)] for each in (rest, followed))
    block = max(1, round(AVERAGED * rate))
    whole = len(followed) // block * block
    if not len(rest) or not whole:
        return float("nan")
    wanted = _mean(rest)
    means = np.array([_mean(each) for each in followed[:whole].reshape(-1, block, 4)])
    along = np.clip(np.abs(means @ wanted), 0.0, 1.0)
    across = np.linalg.norm(means - np.sign(means @ wanted)[:, None] * wanted, axis=1)
    return float(np.sqrt(np.mean((2.0 * np.arctan2(across, along)) ** 2)))


def _mean(orientation: np.ndarray) -> np.ndarray:
    sign = np.where(orientation @ orientation[0] < 0.0, -1.0, 1.0)
    mean = sign @ orientation
    return np.asarray(mean / np.linalg.norm(mean))
