"""One shot in lines: what was played, what came back, and the noise in it."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Shot:
    """One shot in lines.

    Parameters
    ----------
    drive : complex array, shape (lines, inputs), V s
    response : complex array, shape (lines, outputs), m/s^2 s
    noise : array, shape (lines, outputs), (m/s^2 s)^2
        E |N|^2 in the response.
    mains : tuple of arrays
        What its silences show of the mains; see `vibractl.mains.Pieces`.
    """

    drive: np.ndarray
    response: np.ndarray
    noise: np.ndarray
    mains: tuple[np.ndarray, ...] = ()
