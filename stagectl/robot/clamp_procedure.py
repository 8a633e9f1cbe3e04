"""The clamping procedure as data: every step in order, what it may do, and its motions in words before any is made."""

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from stagectl.robot.arm import Arm

Kind = Literal["move", "soften", "clamp", "check", "search", "alternate", "unclamp", "stiffen"]
KINDS: tuple[Kind, ...] = ("move", "soften", "clamp", "check", "search", "alternate", "unclamp", "stiffen")


@dataclass(frozen=True)
class Step:
    """One step of the procedure.

    Parameters
    ----------
    kind : str
    joint : int
        From 0; -1 where it is not about one.
    target : tuple of float, rad
        Of a move; else empty.
    words : str
        What it does, with all numbers.
    """

    kind: Kind
    joint: int
    target: tuple[float, ...]
    words: str


@dataclass(frozen=True)
class ClampLimits:
    """How a procedure moves joints and when it gives up, an entry a joint, on the joints' side of the gears.

    Parameters
    ----------
    softness : array, shape (joints,), 1
        Part of the position gain that soft servo takes away.
    speed : array, shape (joints,), rad/s
        Of references while clamped.
    approach : float, rad/s
        Of the fastest joint on the way to the clamp and back.
    torque : array, shape (joints,), N m
        Beyond it the procedure aborts.
    turn : array, shape (joints,), N m
        Where an alternating motion turns; below `torque`.
    proof : array, shape (joints,), N m
        That a clamped joint must meet in the clamp check; up to `turn`.
    quiet : array, shape (joints,), N m
        What counts as no torque in the search.
    travel : array, shape (joints,), rad
        By which a motor may move from where it was clamped; further, the clamp slips.
    reach : array, shape (joints,), rad
        By which a reference may leave where it was at clamping.
    search_step : array, shape (joints,), rad
        First step of a reference in the search.
    rounds : int
        Of the search over all joints, at most.
    settle : float, s
        After a motion, before torque is looked at; as long, its mean is taken.
    cycles : int
        To and fro of every joint.
    patience : float, s
        For soft servo and clamp to answer.
    """

    softness: np.ndarray
    speed: np.ndarray
    approach: float
    torque: np.ndarray
    turn: np.ndarray
    proof: np.ndarray
    quiet: np.ndarray
    travel: np.ndarray
    reach: np.ndarray
    search_step: np.ndarray
    rounds: int
    settle: float
    cycles: int
    patience: float

    def __post_init__(self) -> None:
        """Refuse numbers that are none, not positive, or in the wrong order."""
        for field in fields(self):
            values = np.asarray(getattr(self, field.name), float)
            if not (np.isfinite(values).all() and (values > 0).all()):
                raise ValueError(f"clamping.{field.name} is {_said(values)}, must be finite and > 0")
        if not (self.softness < 1).all():
            raise ValueError(f"clamping.softness is {_said(self.softness)}, must be < 1")
        for less, more in (("quiet", "proof"), ("turn", "torque"), ("search_step", "reach")):
            self._refuse_unless((getattr(self, less) < getattr(self, more)).all(), f"{less} < {more}")
        self._refuse_unless((self.proof <= self.turn).all(), "proof <= turn")
        if self.cycles < 2:
            raise ValueError(f"clamping.cycles is {self.cycles}, must be >= 2")

    def _refuse_unless(self, holds: np.bool, rule: str) -> None:
        """Refuse two limits that are not in the order of `rule`, such as "quiet < proof"."""
        name, sign, other = rule.split()
        if not holds:
            raise ValueError(
                f"clamping.{name} is {_said(getattr(self, name))}, must be {sign} clamping.{other}, "
                f"{_said(getattr(self, other))}"
            )


def _said(values: np.ndarray) -> str:
    """Return numbers, one or one a joint, as a person writes them."""
    return ", ".join(f"{value:g}" for value in np.ravel(values))


@dataclass(frozen=True)
class ClampProcedure:
    """Which joints are measured in which pose.

    Parameters
    ----------
    arm : Arm
    pose : array, shape (joints,), rad
        Where the tool is clamped.
    leave : array, shape (joints,), rad
        Where the arm goes when all is done.
    joints : tuple of int
        To be actuated, from 0, in this order.
    limits : ClampLimits

    Raises
    ------
    ValueError : a pose outside the arm's limits, a joint it has not, limits for another number of joints.
    """

    arm: Arm
    pose: np.ndarray
    leave: np.ndarray
    joints: tuple[int, ...]
    limits: ClampLimits

    def __post_init__(self) -> None:
        """Refuse what the arm cannot do."""
        self.arm.refuse_outside(np.array([self.pose, self.leave]))
        if not self.joints or len(set(self.joints)) != len(self.joints):
            raise ValueError(f"the joints are {[joint + 1 for joint in self.joints]}, must be some, each once")
        wrong = [joint + 1 for joint in self.joints if not 0 <= joint < self.arm.joints]
        if wrong:
            raise ValueError(f"joint {wrong[0]} is not there, must be 1 to {self.arm.joints}")
        for field in fields(self.limits):
            values = getattr(self.limits, field.name)
            if isinstance(values, np.ndarray) and values.shape != (self.arm.joints,):
                raise ValueError(f"{field.name} has shape {values.shape}, must be ({self.arm.joints},)")

    def steps(self) -> list[Step]:
        """Return the steps in order."""
        limits, pose, leave = self.limits, tuple(map(float, self.pose)), tuple(map(float, self.leave))
        soft = ", ".join(f"{100 * part:g}" for part in limits.softness)
        found = [
            Step("move", -1, pose, f"move to the clamping pose {_degrees(pose)} at {_rate(limits.approach)}"),
            Step("soften", -1, (), f"soft servo on: integral off, position gain less by {soft} %"),
            Step("clamp", -1, (), f"clamp the tool; wait up to {limits.patience:g} s"),
        ]
        found += [Step("check", joint, (), self._pushes(joint, limits.proof, 1)) for joint in self.joints]
        quiet = ", ".join(f"{torque:g}" for torque in limits.quiet)
        step = ", ".join(f"{1e3 * size:g}" for size in limits.search_step)
        words = f"search zero torque: joint by joint, steps of {step} mrad and less, until within {quiet} N m"
        found.append(Step("search", -1, (), f"{words}; at most {limits.rounds} rounds"))
        found += [
            Step("alternate", joint, (), self._pushes(joint, limits.turn, limits.cycles)) for joint in self.joints
        ]
        return [
            *found,
            Step("unclamp", -1, (), f"unclamp the tool; wait up to {limits.patience:g} s"),
            Step("stiffen", -1, (), "soft servo off"),
            Step("move", -1, leave, f"leave for {_degrees(leave)} at {_rate(limits.approach)}"),
        ]

    def _pushes(self, joint: int, torque: np.ndarray, cycles: int) -> str:
        limits = self.limits
        what = "clamp check" if cycles == 1 else f"{cycles} cycles"
        return (
            f"joint {joint + 1}, {what}: to +-{torque[joint]:g} N m and back at {_rate(limits.speed[joint])} of the "
            f"reference; motor within {1e3 * limits.travel[joint]:g} mrad, reference within "
            f"{1e3 * limits.reach[joint]:g} mrad, abort at {limits.torque[joint]:g} N m"
        )


def _degrees(angles: tuple[float, ...]) -> str:
    return f"({', '.join(f'{angle:g}' for angle in np.degrees(angles).round(3))}) deg"


def _rate(speed: float) -> str:
    return f"{np.degrees(speed):.3g} deg/s"
