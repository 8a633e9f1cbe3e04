"""What the calibrations of the cell may be begun with, which stand above this package."""

from typing import Literal

from rigkit.config import setting
from stagectl.daemon.cell_options import MODEL, Paced
from stagectl.daemon.options import Renewed


class MillingOptions(Paced, Renewed):
    """Models of the robot, and of what milling does to it."""

    model: str = setting("milling.h5", "", "model file to write in the data folder", pattern=MODEL)
    task: Literal["pocket28", "pocket28-deep", "pocket"] = setting("pocket28", "", "pocket is that of [pocket]")


class JointsOptions(Paced, Renewed):
    """Backlash, stiffness and friction of joints whose tool is clamped."""

    model: str = setting("joints.h5", "", "model file to write in the data folder", pattern=MODEL)
    joints: str = setting(
        "1-6", "", "which: numbers and ranges, such as 1-3,6", pattern=r"^[1-9](-[1-9])?(,[1-9](-[1-9])?){0,5}$"
    )
    compensate: Literal["best", "none", "clamp", "tool", "link"] = setting(
        "best", "", "by what the arm's side is known that counts"
    )
