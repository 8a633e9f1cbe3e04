"""Lasers, corner frequency and prefilters as named arrays, to be uploaded to the stage's processor, and back."""

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass

import numpy as np

from stagectl.stage.laser_check import LaserLimits
from stagectl.stage.prefilter import Prefilter

LASER, CORNER, PREFILTER = "laser", "deflection.corner", ".prefilter"
HIGHEST = 0.4
"""Corner frequency re the laser's rate: above, the steps from reading to reading are let through (docs/stage.md)."""
_MOST = 10_000


@dataclass(frozen=True)
class DeflectionLoop:
    """What the processor does with its lasers.

    Parameters
    ----------
    limits : LaserLimits
    corner : float or None, Hz
        None: they are read and shown, and nothing is compensated.
    prefilters : sequence of Prefilter or None
        One of each an axis, or none at all.
    """

    limits: LaserLimits
    corner: float | None = None
    prefilters: Sequence[Prefilter | None] = ()


def refuse_corner(corner: float, rate: float, name: str = "deflection.corner") -> None:
    """Refuse, by ValueError, a corner frequency that is too high for a laser.

    Parameters
    ----------
    corner, rate : float, Hz
        Of the low-pass, and of the laser's readings.
    name : str
    """
    if not 0 < corner <= HIGHEST * rate:
        raise ValueError(
            f"{name} is {corner:g} Hz, must be > 0 and <= {HIGHEST * rate:g} Hz with a laser of {rate:g} readings/s"
        )


def deflection_parameters(axes: Sequence[str], loop: DeflectionLoop) -> dict[str, np.ndarray]:
    """Return the numbers of a deflection loop, `laser`, `deflection.corner` and `x.prefilter` to `z.prefilter`.

    Parameters
    ----------
    axes : sequence of str, such as x, y, z
    loop : DeflectionLoop

    Returns
    -------
    dict of arrays, float64: shape (4,), the fields of `LaserLimits`; (1,), Hz; (1 + taps,), spacing and taps
    """
    found = {LASER: np.array(astuple(loop.limits), float)}
    if loop.corner is not None:
        found[CORNER] = np.array([loop.corner])
        for axis, each in zip(axes, loop.prefilters, strict=bool(loop.prefilters)):
            if each is not None:
                found[f"{axis}{PREFILTER}"] = np.array([each.spacing, *each.taps])
    return found


def is_deflection(name: str) -> bool:
    """Whether a parameter belongs to a deflection loop."""
    return name in (LASER, CORNER) or name.endswith(PREFILTER)


def deflection_from(axes: Sequence[str], parameters: Mapping[str, np.ndarray]) -> DeflectionLoop:
    """Return the deflection loop.

    Parameters
    ----------
    axes : sequence of str
    parameters : mapping of str to array, shapes (4,), (1,) and (1 + taps,), as of `deflection_parameters`

    Raises
    ------
    ValueError : a number is missing, unknown or out of its range.
    """
    known = {LASER, CORNER, *(f"{axis}{PREFILTER}" for axis in axes)}
    odd = sorted(parameters.keys() - known)
    if odd or LASER not in parameters:
        raise ValueError(f"parameter {odd[0]} is unknown" if odd else f"parameter {LASER} is missing")
    numbers = parameters[LASER]
    if numbers.shape != (4,) or not ((numbers > 0) | ([False, True, False, False] & (numbers == 0))).all():
        raise ValueError(f"parameter {LASER} is {numbers}, must be rate, late, stuck and speed, > 0")
    limits = LaserLimits(*map(float, numbers))
    if CORNER not in parameters:
        if len(parameters) > 1:
            raise ValueError(f"parameter {CORNER} is missing, must be there with prefilters")
        return DeflectionLoop(limits)
    if parameters[CORNER].shape != (1,):
        raise ValueError(f"parameter {CORNER} has shape {parameters[CORNER].shape}, must be (1,)")
    corner = float(parameters[CORNER][0])
    refuse_corner(corner, limits.rate)
    return DeflectionLoop(limits, corner, tuple(_prefilter(parameters, f"{axis}{PREFILTER}") for axis in axes))


def _prefilter(parameters: Mapping[str, np.ndarray], name: str) -> Prefilter | None:
    values = parameters.get(name)
    if values is None:
        return None
    is_filter = values.ndim == 1 and len(values) > 1 and abs(values[1:].sum() - 1) <= 1e-3
    if not (is_filter and values[0] == round(values[0]) and 1 <= values[0] and values[0] * len(values) <= _MOST):
        raise ValueError(f"parameter {name} is no prefilter: a spacing of 1 or more, and taps whose sum is 1")
    return Prefilter(values[1:].copy(), int(values[0]), 0.0, np.nan, np.nan)
