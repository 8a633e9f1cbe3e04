"""Where the simulated stage's plate is, in a file that another simulator looks into: the tracker sees the spindle."""

from pathlib import Path

import numpy as np

from stagectl.wire.messages import AXES

_SHAPE = (len(AXES),)


def write_plate(path: Path) -> np.ndarray:
    """Make the file; return what it shows, shape (3,), m from mid-travel, to be written into.

    Parameters
    ----------
    path : Path
    """
    return np.memmap(path, float, "w+", shape=_SHAPE)


def seen_plate(path: Path) -> np.ndarray:
    """Return what the file of a stage that runs shows, shape (3,), m from mid-travel; live.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError : there is no such file, or it is none of a stage's.
    """
    try:
        return np.memmap(path, float, "r", shape=_SHAPE)
    except (OSError, ValueError) as fault:
        raise ValueError(
            f"--plate is {path}, must be the file `plate` in the --folder of `firmware-sim stage`: {fault}"
        ) from None
