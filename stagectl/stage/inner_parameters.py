"""Inner loops as named arrays, to be uploaded to the stage's processor, and back."""

from collections.abc import Mapping, Sequence
from dataclasses import astuple, fields

import numpy as np

from stagectl.stage.piezo_pid import Pid

SUFFIX = ".inner"


def inner_parameters(axes: Sequence[str], loops: Sequence[Pid]) -> dict[str, np.ndarray]:
    """Return the numbers of the loops, `x.inner` to `z.inner`.

    Parameters
    ----------
    axes : sequence of str, such as x, y, z
    loops : sequence of Pid, one an axis

    Returns
    -------
    dict of arrays, float64, shape (6,), the fields of `Pid` in their order and units
    """
    return {f"{axis}{SUFFIX}": np.array(astuple(loop), float) for axis, loop in zip(axes, loops, strict=True)}


def inner_from(axes: Sequence[str], parameters: Mapping[str, np.ndarray]) -> list[Pid]:
    """Return the loops, one an axis.

    Parameters
    ----------
    axes : sequence of str
    parameters : mapping of str to array, shape (6,), the fields of `Pid` in their order and units

    Raises
    ------
    ValueError : a loop is missing or unknown, or its numbers are not those of one.
    """
    wanted = {f"{axis}{SUFFIX}" for axis in axes}
    if wanted != parameters.keys():
        odd = sorted(wanted ^ parameters.keys())[0]
        raise ValueError(f"parameter {odd} is {'missing' if odd in wanted else 'unknown'}")
    loops = []
    for name in (f"{axis}{SUFFIX}" for axis in axes):
        if parameters[name].shape != (len(fields(Pid)),):
            raise ValueError(f"parameter {name} has shape {parameters[name].shape}, must be {(len(fields(Pid)),)}")
        loop = Pid(*map(float, parameters[name]))
        if not (np.isfinite(parameters[name]).all() and loop.smoothing > 0 and loop.tracking > 0):
            raise ValueError(f"parameter {name} is {parameters[name]}, must be finite, its time constants > 0 s")
        loops.append(loop)
    return loops
