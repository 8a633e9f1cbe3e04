"""How loud a drive may be: what it needs of each limit of the guard, and the level at which it keeps all of them."""

from typing import Annotated

import numpy as np
import typer
from scipy.signal import lfilter

from vibractl.config import Limits, RigConfig
from vibractl.guard import violation
from vibractl.reference import is_file

QUANTITIES = (("peak", "V"), ("rms", "V"), ("slew", "V/s"))
"""What the guard limits; rms is the root of its exponential mean at its largest."""
ROOM = 0.5
"""Of the limits, that a first drive takes of a run whose amplitude is fitted: distortion is made up for by more."""

FitOption = Annotated[
    bool, typer.Option("--fit-amplitude", help="Lower the reference's amplitude where the limits leave no headroom.")
]


def drive_sizes(drive: np.ndarray, limits: Limits, rate: float) -> np.ndarray:
    """Return peak, rms and slew of each coil, (coils, 3), V, V and V/s, as the guard sees them.

    Parameters
    ----------
    drive : array, shape (samples, coils), V
        From rest to rest.
    limits : Limits
    rate : float, samples/s
    """
    forget = -np.expm1(-1.0 / (limits.rms_seconds * rate))
    mean = lfilter([forget], [1.0, forget - 1.0], drive**2, axis=0)
    slew = np.abs(np.diff(drive, axis=0, prepend=0.0, append=0.0)).max(axis=0) * rate
    return np.stack([np.abs(drive).max(axis=0), np.sqrt(mean.max(axis=0)), slew], axis=-1)


def allowed_sizes(limits: Limits) -> np.ndarray:
    """Return the limits beside `drive_sizes`, (3,), V, V and V/s."""
    return np.array([getattr(limits, name) for name, _ in QUANTITIES])


def fitting_level(drive: np.ndarray, limits: Limits, rate: float) -> float:
    """Return by what a drive may be multiplied at most; infinite for silence.

    Parameters
    ----------
    drive : array, shape (samples, coils), V
    limits : Limits
    rate : float, samples/s
    """
    with np.errstate(divide="ignore"):
        return float((allowed_sizes(limits) / drive_sizes(drive, limits, rate)).min())


def too_loud(drive: np.ndarray, limits: Limits, rate: float) -> str:
    """Say in one line which limit a drive breaks, what it needs and at which level it fits; empty where it keeps all.

    Parameters
    ----------
    drive : array, shape (samples, coils), V
    limits : Limits
    rate : float, samples/s
    """
    broken = violation(drive, limits, rate)
    if broken is None or broken.limit == "finite":
        return "" if broken is None else str(broken)
    place = [name for name, _ in QUANTITIES].index(broken.limit)
    needed = drive_sizes(drive, limits, rate)[:, place].max()
    level = fitting_level(drive, limits, rate)
    return f"{broken}; it needs {needed:.4g} {QUANTITIES[place][1]}, and fits at {level:.3g} of its level"


def at_level(config: RigConfig, level: float) -> RigConfig:
    """Return settings with a reference that is so many times as loud.

    Parameters
    ----------
    config : RigConfig
    level : float, > 0

    Raises
    ------
    ValueError : the reference is a file that says its own units.
    """
    wanted, key = config.reference, _key(config)
    if not getattr(wanted, key) > 0:
        raise ValueError(
            f"reference.signal is {wanted.signal}, which says its own units: multiply it by {level:.3g} at most"
        )
    louder = wanted.model_copy(update={key: float(f"{level * getattr(wanted, key):.3g}")})
    return config.model_copy(update={"reference": louder})


def told_level(config: RigConfig) -> str:
    """Say how loud a reference is, by its key."""
    return f"reference.{_key(config)} is {getattr(config.reference, _key(config)):g} m/s^2"


def _key(config: RigConfig) -> str:
    return "full_scale" if is_file(config.reference.signal) else "amplitude"
