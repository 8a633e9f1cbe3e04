"""The variables of MATLAB's files up to version 7, which scipy reads whole."""

import re
from math import prod
from pathlib import Path

import numpy as np
import scipy.io

from rigkit.array_hdf5 import COMPRESSED
from rigkit.array_room import let_have
from rigkit.array_variables import Contents, RefusedError, Variable

COPIES = 3
"""Of what is read, in memory at once."""
_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
"""What MATLAB calls a variable."""
_NUMBERS = ("double", "single", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")


def mat_contents(path: Path) -> Contents:
    """Return what is in a file.

    Parameters
    ----------
    path : Path

    Raises
    ------
    RefusedError : a damaged file, or a variable that cannot be in it.
    """
    try:
        listed = scipy.io.whosmat(str(path))
        size, declared = path.stat().st_size, 0
        for name, shape, kind in listed:
            if not _NAME.fullmatch(name):
                raise RefusedError(f"is damaged: a variable is called {name!r}, must be letters, digits and _")
            declared += 8 * prod(shape) if kind in _NUMBERS else 0
            if declared > COMPRESSED * size:
                raise RefusedError(f"{name} has {8 * prod(shape)} bytes, in a file of {size}")
        let_have(COPIES * declared)
        wanted = [name for name, shape, kind in listed if kind in _NUMBERS and len(shape) == 2 and prod(shape) > 0]
        held = scipy.io.loadmat(str(path), variable_names=wanted) if wanted else {}
    except RefusedError:
        raise
    except Exception as fault:  # of a damaged file scipy raises whatever comes
        raise RefusedError(f"is no MAT file, or a damaged one ({' '.join(str(fault).split())})") from None
    found = Contents()
    for name, shape, kind in listed:
        array = held.get(name)
        if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu" or array.ndim != 2:
            found.others.append(f"{name} ({' x '.join(map(str, shape))} {kind})")
        elif array.size == 1:
            found.numbers[name] = array.item()
        else:
            found.variables.append(_variable(name, array))
    return found


def _variable(name: str, array: np.ndarray) -> Variable:
    array = array.T if array.shape[0] == 1 else array  # a row is a signal like a column
    return Variable(name, array.shape[0], array.shape[1], lambda start, stop: array[start:stop])
