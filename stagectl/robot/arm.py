"""An arm's geometry and limits: Denavit-Hartenberg parameters read from a file, SI inside."""

import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from rigkit.config_fault import ConfigError
from rigkit.config_source import file_values

_COLUMNS = ("offset_deg", "d", "a", "alpha_deg", "low_deg", "high_deg", "speed_deg")


class ArmError(ValueError):
    """A file of an arm that cannot be used; names file, joint, key and value."""


@dataclass(frozen=True)
class Arm:
    """A serial arm of rotary joints after the standard Denavit-Hartenberg convention.

    From the frame of link i - 1 to that of link i: turn by the joint angle plus `offset` about z, move by `d` along
    it, by `a` along the new x, and turn by `alpha` about that x.

    Parameters
    ----------
    name : str
    offset, alpha : array, shape (joints,), rad
    d, a : array, shape (joints,), m
    low, high : array, shape (joints,), rad
        Limits of the joint angles.
    speed : array, shape (joints,), rad/s
        Fastest a joint turns.
    """

    name: str
    offset: np.ndarray
    d: np.ndarray
    a: np.ndarray
    alpha: np.ndarray
    low: np.ndarray
    high: np.ndarray
    speed: np.ndarray

    @property
    def joints(self) -> int:
        """How many joints it has."""
        return len(self.d)

    @property
    def reach(self) -> float:
        """An upper bound of the distance from base to flange, m."""
        return float(np.hypot(self.d, self.a).sum())

    def with_tool(self, length: float) -> "Arm":
        """Return the arm with its flange moved on by `length` (m) along the last axis, to a tool's point."""
        return replace(self, d=self.d + length * np.eye(self.joints)[-1])

    def refuse_outside(self, joint_angle: np.ndarray) -> None:
        """Refuse angles outside the limits by ValueError with joint, value and range.

        Parameters
        ----------
        joint_angle : array, shape (..., joints), rad
        """
        angle = np.asarray(joint_angle, float)
        if angle.ndim == 0 or angle.shape[-1] != self.joints:
            raise ValueError(f"joint angles have shape {angle.shape}, must be (..., {self.joints}) for {self.name}")
        wrong = np.argwhere(~((angle >= self.low) & (angle <= self.high)))
        if len(wrong):
            joint = int(wrong[0][-1])
            value, low, high = np.degrees([angle[tuple(wrong[0])], self.low[joint], self.high[joint]])
            raise ValueError(f"joint {joint + 1} is at {value:.6g} deg, must be {low:g} to {high:g}")


def read_arm(path: str | Path) -> Arm:
    """Read an arm: `name`, and a table `joint` a joint with the keys of `irb140.toml`, degrees and metres.

    Raises
    ------
    ArmError : no such file, no TOML, a key that is missing or too many, a value that is no number, limits that fall.
    """
    try:
        content = file_values(path)
    except ConfigError as fault:
        raise ArmError(str(fault)) from None
    return _arm(str(path), content)


def irb140() -> Arm:
    """Return the ABB IRB 140 of the thesis, with its published lengths and limits."""
    text = files("stagectl.robot").joinpath("irb140.toml").read_text(encoding="utf-8")
    return _arm("irb140.toml", tomllib.loads(text))


def _arm(path: str, content: Mapping[str, Any]) -> Arm:
    if set(content) != {"name", "joint"} or not isinstance(content["joint"], list) or not content["joint"]:
        raise ArmError(f"{path}: has {', '.join(content) or 'nothing'}, must have name and a list of joint")
    table = np.array([_row(path, number, row) for number, row in enumerate(content["joint"], start=1)])
    for number, (low, high, speed) in enumerate(table[:, 4:], start=1):
        if not (low < high and speed > 0):
            raise ArmError(
                f"{path}: joint {number} goes from {low:g} to {high:g} deg at {speed:g} deg/s, must rise, > 0"
            )
    offset, alpha, low, high, speed = np.radians(table[:, [0, 3, 4, 5, 6]]).T
    return Arm(str(content["name"]), offset, table[:, 1], table[:, 2], alpha, low, high, speed)


def _row(path: str, number: int, row: object) -> list[float]:
    if not isinstance(row, dict) or set(row) != set(_COLUMNS):
        raise ArmError(f"{path}: joint {number} must have {', '.join(_COLUMNS)}")
    for key in _COLUMNS:
        value = row[key]
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
            raise ArmError(f"{path}: joint {number}: {key} is {value!r}, must be a finite number")
    return [float(row[key]) for key in _COLUMNS]
