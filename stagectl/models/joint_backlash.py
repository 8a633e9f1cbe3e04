"""What of a file of joint models, as `calibrate joints` writes it, a path may carry: the lost motion that is known."""

from collections.abc import Callable, Collection, Mapping
from pathlib import Path

import numpy as np

from rigkit.model_file import ModelFileError, read_model_file
from stagectl.models.model_origin import refuse_other_wiring
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.lost_motion import LostMotion

FORMAT = "vibrostage joint models 1"
FIGURES = ("backlash", "k_plus", "k_minus", "friction")
"""Each with its value, standard error, and half of its interval in standard errors."""
JOINTS = 6


def lost_motion(
    file: Path, cell: CellConfig, gravity: np.ndarray, accept: Collection[str], note: Callable[[str], object]
) -> LostMotion | None:
    """Read the lost motion of joints; None, with a note, where nothing is left of it.

    A joint is left out whose backlash is not known better than its interval, or which gravity holds to one side of it:
    that one does not cross it when it turns around.  Friction's wind-up counts where it is known as well.

    Parameters
    ----------
    file : Path
        Of joint models.
    cell : CellConfig
    gravity : array, shape (N, 6), N m
        What holds the arm up along the path.
    accept : collection of str
        Keys in which the cell that it was measured on may differ.
    note : callable(str)
        Told what is left out, and why.

    Raises
    ------
    ModelFileError : no such file, a damaged one, or figures that are none.
    DisagreementError : measured on another robot.
    """
    content = read_model_file(file, FORMAT, ("joint", "has_backlash", *FIGURES))
    for text in refuse_other_wiring(cell, file, content.provenance, accept, "cell"):
        note(text)
    half = np.zeros(JOINTS)
    for place, joint in enumerate(_joints(file, content.arrays)):
        known = {name: content.arrays[name][place] for name in FIGURES}
        held = float(np.abs(gravity[:, joint - 1]).min())
        why = _left_out(known, bool(content.arrays["has_backlash"][place]), held)
        if why:
            note(f"{file}: joint {joint} is left out: {why}")
        else:
            half[joint - 1] = _half(known)
    return LostMotion(half) if half.any() else None


def _joints(file: Path, arrays: Mapping[str, np.ndarray]) -> list[int]:
    joints = [int(each) for each in np.atleast_1d(arrays["joint"])]
    if not set(joints) <= set(range(1, JOINTS + 1)) or len(set(joints)) != len(joints):
        raise ModelFileError(f"{file}: its joints are {joints}, must be of 1 to {JOINTS}, each once")
    for name in FIGURES:
        value = arrays[name]
        if value.shape != (len(joints), 3) or not np.isfinite(value).all():
            raise ModelFileError(
                f"{file}: {name} has shape {value.shape}, must be ({len(joints)}, 3) of finite numbers"
            )
    return joints


def _left_out(known: Mapping[str, np.ndarray], has_backlash: bool, held: float) -> str:
    value, error, reach = known["backlash"]
    if not has_backlash or not value > reach * error:
        return f"its backlash is {1e3 * value:.3f} ± {1e3 * reach * error:.3f} mrad, must be more than its interval"
    if held > known["friction"][0]:
        return f"gravity holds it to one side with {held:.3g} N m or more, its friction is {known['friction'][0]:.3g}"
    return ""


def _half(known: Mapping[str, np.ndarray]) -> float:
    backlash, friction = known["backlash"][0], known["friction"]
    stiffness = 0.5 * (known["k_plus"][0] + known["k_minus"][0])
    wound = friction[0] / stiffness if stiffness > 0.0 and friction[0] > friction[2] * friction[1] else 0.0
    return float(0.5 * backlash + wound)
