"""A sweep of an arm through its workspace: moves between poses, and slow motions to and fro in each."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from stagectl.robot.arm import Arm
from stagectl.robot.kinematics import forward
from stagectl.robot.learning_config import Friction

RAMP = 0.6
"""s in which a move gathers speed, and loses it again."""
LOOKS = 60
"""Places of a move at which the tool is looked for."""
MOST_TRIES = 4_000
USED = 0.8
"""Part of the tool's speed limit that a move uses."""
SLOWEST_TURN, QUICKEST_TURN = 0.35, 0.75
"""Hz, of the motions to and fro; a joint each between, so that no two stay in step."""


@dataclass(frozen=True, eq=False)
class SweepStep:
    """One motion.

    Parameters
    ----------
    kind : "move" or "creep"
    target : array, shape (6,), rad
        Where it ends; of a motion to and fro, its middle.
    seconds : float
    amplitude : array, shape (6,), rad
        Of a motion to and fro; zeros of a move.
    words : str
        What it does, with all numbers.
    """

    kind: Literal["move", "creep"]
    target: np.ndarray
    seconds: float
    amplitude: np.ndarray
    words: str


@dataclass(frozen=True)
class SweepBox:
    """Where the tool may be and how fast.

    Parameters
    ----------
    lowest, highest : tuple of float, m
        Corners of the box in the base.
    tool_speed : float, m/s
    """

    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    tool_speed: float


def plan_sweep(friction: Friction, arm: Arm, box: SweepBox, start: np.ndarray) -> list[SweepStep]:
    """Return the sweep's motions in order; it ends where it starts.

    Parameters
    ----------
    friction : Friction
    arm : Arm
        With its tool.
    box : SweepBox
    start : array, shape (6,), rad
        Where the arm is.

    Raises
    ------
    ValueError : ranges outside the arm's limits, or no poses in them with the tool in its box.
    """
    lowest, highest = np.radians(friction.lowest), np.radians(friction.highest)
    arm.refuse_outside(np.array([lowest, highest, start]))
    if not (lowest < highest).all():
        raise ValueError(f"friction.lowest is {friction.lowest} deg, must be below friction.highest {friction.highest}")
    found, at = [], np.asarray(start, float)
    for number, pose in enumerate(_poses(friction, arm, box, at)):
        found.append(_move(arm, box, at, pose, friction.speed if number % 2 == 0 else friction.speed / 2))
        found.append(_creep(friction, pose, friction.creep[number % len(friction.creep)]))
        at = pose
    found.append(_move(arm, box, at, np.asarray(start, float), friction.speed))
    return found


def path_of(steps: list[SweepStep], start: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the references, shape (samples, 6), rad, and of each sample the number of its step, from 1, (samples,)."""
    at, rows, numbers = np.asarray(start, float), [], []
    for number, step in enumerate(steps, start=1):
        samples = max(2, round(step.seconds * rate))
        time = np.arange(1, samples + 1) / rate
        if step.kind == "move":
            row = at + _progress(time, step.seconds)[:, None] * (step.target - at)
        else:
            row = step.target + step.amplitude * _to_and_fro(time, step.seconds)
        rows.append(row)
        numbers.append(np.full(samples, number))
        at = step.target
    return np.concatenate(rows), np.concatenate(numbers)


def _poses(friction: Friction, arm: Arm, box: SweepBox, start: np.ndarray) -> Iterator[np.ndarray]:
    """Draw poses from the ranges, each to be reached straight from the one before, with the way back."""
    lowest, highest = np.radians(friction.lowest), np.radians(friction.highest)
    drawn = np.random.default_rng(friction.seed).random((MOST_TRIES, 6))
    at, left = start, friction.poses
    for share in drawn:
        pose = lowest + share * (highest - lowest)
        stays = _is_in_box(arm, box, at, pose) and (left > 1 or _is_in_box(arm, box, pose, start))
        if stays:
            yield pose
            at, left = pose, left - 1
        if left == 0:
            return
    raise ValueError(
        f"of {MOST_TRIES} poses between friction.lowest and friction.highest {friction.poses - left} of "
        f"{friction.poses} keep the tool within the box limits.lowest {list(box.lowest)} to limits.highest "
        f"{list(box.highest)} m on the way: does the box fit the arm?"
    )


def _is_in_box(arm: Arm, box: SweepBox, start: np.ndarray, end: np.ndarray) -> bool:
    place = _tool(arm, start, end)
    return bool(((place >= box.lowest) & (place <= box.highest)).all())


def _tool(arm: Arm, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the tool's places on a straight way of the joints, shape (LOOKS, 3), m."""
    return forward(arm, start + np.linspace(0, 1, LOOKS)[:, None] * (end - start))[:, :3, 3]


def _move(arm: Arm, box: SweepBox, start: np.ndarray, end: np.ndarray, speed: float) -> SweepStep:
    way = np.linalg.norm(np.diff(_tool(arm, start, end), axis=0), axis=1).max() * (LOOKS - 1)
    fastest = float(np.abs((end - start) / np.minimum(speed, arm.speed)).max())
    cruise = max(fastest, float(way) / (USED * box.tool_speed), RAMP)
    rates = ", ".join(f"{each:.3g}" for each in np.degrees(np.abs(end - start) / cruise))
    words = f"move to {_degrees(end)} deg in {cruise + RAMP:.3g} s, at up to {rates} deg/s"
    return SweepStep("move", end, cruise + RAMP, np.zeros(6), words)


def _creep(friction: Friction, pose: np.ndarray, speed: float) -> SweepStep:
    amplitude = speed / (2 * np.pi * _turns())
    sizes = ", ".join(f"{each:.2g}" for each in np.degrees(amplitude))
    words = f"to and fro by {sizes} deg for {friction.seconds:g} s, at up to {np.degrees(speed):.3g} deg/s"
    return SweepStep("creep", pose, friction.seconds, amplitude, words)


def _turns() -> np.ndarray:
    return np.geomspace(SLOWEST_TURN, QUICKEST_TURN, 6)


def _progress(time: np.ndarray, seconds: float) -> np.ndarray:
    """Return how far a move is, from 0 to 1: speed rises and falls as a raised cosine, and is constant in between."""
    top = 1.0 / (seconds - RAMP)

    def gathered(since: np.ndarray) -> np.ndarray:
        part = np.clip(since, 0.0, RAMP)
        return np.asarray(0.5 * (part - RAMP / np.pi * np.sin(np.pi * part / RAMP)))

    whole = gathered(time) + np.clip(time - RAMP, 0.0, None) - gathered(time - (seconds - RAMP))
    return np.asarray(top * whole)


def _to_and_fro(time: np.ndarray, seconds: float) -> np.ndarray:
    """Return motions of the joints, shape (samples, 6), 1: sines of different pace, faded in and out."""
    fade = np.clip(np.minimum(time, seconds - time) / RAMP, 0.0, 1.0)
    return np.asarray((fade**2 * (3 - 2 * fade))[:, None] * np.sin(2 * np.pi * np.outer(time, _turns())))


def _degrees(angles: np.ndarray) -> str:
    return f"({', '.join(f'{angle:g}' for angle in np.degrees(angles).round(2))})"
