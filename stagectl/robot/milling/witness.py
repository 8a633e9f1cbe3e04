"""What was measured held against what models make of it: whether they are of this robot, and logs what they are called.

A model that is of another robot, a force whose sign is reversed, a log in other units: each makes a learned path worse
than the one it began with, and none is seen in what is learned from.  So one signal is foreseen from others, and has
to go with what was measured of it.
"""

import numpy as np

from stagectl.robot.milling.agreement import Agreement, agreement, lateness
from stagectl.robot.milling.axis_model import AxisModel, robot_response
from stagectl.robot.milling.zero_phase import filtered

ALIKE = 0.5
"""Correlation from which on a slope tells something."""
FOLLOWS = 0.85, 1.18
"""Slopes of a motor's path on what G_R makes of the path that was sent, between which they are of one robot."""
BENDS = 0.55, 1.8
"""Slopes of what the tracker saw bent on G_K times the force, likewise."""
CUTS = 0.25, 4.0
"""Slopes of the force on what G_M makes of the tool's path, likewise: they tell a sign and a unit, and no more."""
APART, FAR = 0.04, 0.3
"""s by which force and tracker may be apart, and are looked for."""
LEAST = 0.02
"""Of what is foreseen: what is less is no signal."""
SURE, SURELY_LATE = 3.0, 4.0
"""Standard errors by which a slope of 1, or a clock that is right, has to be out of reach; of many shifts one is best.
"""
NOISY = 1.5
"""Times what noise makes: what the tracker saw bent by no more tells nothing."""


def refuse_other_robot(sent: np.ndarray, joints: np.ndarray, axes: tuple[AxisModel, ...], source: str) -> None:
    """Refuse, by ValueError, a G_R that is not of the robot that has gone along a path in the air.

    Parameters
    ----------
    sent, joints : arrays, shape (N, 3), m
        u, and y_r.
    axes : three AxisModel
        G_R to the motors' angles.
    source : str
        What is told of: "free-0".
    """
    rate = axes[0].rate
    foreseen = filtered(sent, rate, lambda frequency: robot_response(axes, frequency))
    for number, axis in enumerate("xyz"):
        found = agreement(joints[:, [number]], foreseen[:, [number]], rate)
        if found.foreseen == 0.0 or FOLLOWS[0] <= found.slope <= FOLLOWS[1]:
            continue
        raise ValueError(
            f"{source}: along {axis} the motors went {found.slope:.3g} times as far as G_R has it, must be "
            f"{FOLLOWS[0]:g} to {FOLLOWS[1]:g}: {_why(found, 'the path', 'G_R')}"
        )


def refuse_other_axes(seen: np.ndarray, joints: np.ndarray, rate: float, source: str) -> None:
    """Refuse, by ValueError, a tracker that does not see the tool go as the motors' angles have it.

    Parameters
    ----------
    seen, joints : arrays, shape (N, 3), m
        y_n and y_r: they differ by the arm's bending, which is little beside the path.
    rate : float, samples/s
    source : str
        What is told of: "tracker.csv".
    """
    for number, axis in enumerate("xyz"):
        each = [agreement(seen[:, [number]], joints[:, [other]], rate) for other in range(3)]
        if joints[:, number].std() < LEAST_MOVED or FOLLOWS[0] <= each[number].slope <= FOLLOWS[1]:
            continue
        raise ValueError(
            f"{source}: {axis} goes {each[number].slope:.3g} times as far as the motors' angles have it, must be "
            f"{FOLLOWS[0]:g} to {FOLLOWS[1]:g}; {_likely(each, number)}"
        )


def _likely(each: list[Agreement], number: int) -> str:
    """Return in words why an axis does not go as it should, from how it goes with all three."""
    like = int(np.argmax([abs(found.correlation) for found in each]))
    if like != number:
        sign = "-" if each[like].correlation < 0 else ""
        return f"it goes as {sign}{'xyz'[like]} does: are its axes the base's?"
    return "its sign is reversed" if each[number].slope < 0 else "is it in m?"


def refuse_other_compliance(bent: np.ndarray, foreseen: np.ndarray, rate: float, source: str) -> None:
    """Refuse, by ValueError, a force and a G_K that do not make what the tracker saw.

    A cut that bends the tool by little beside the tracker's noise tells little: what is beyond its bounds is refused
    where it is beyond what chance makes of models and clocks that are right, as well.

    Parameters
    ----------
    bent : array, shape (N, 3), m
        y_n - y_r - d_e, where the tool is in the material.
    foreseen : array, shape (N, 3), m
        G_K f.
    rate : float, samples/s
    source : str
        What is told of: "milled-0".
    """
    found = agreement(bent, foreseen, rate)
    seen = found.measured if found.measured > NOISY * found.noise else 0.0
    if max(seen, found.foreseen) < LEAST_BENT:
        return
    if found.foreseen < LEAST * seen and abs(found.correlation) < ALIKE:
        raise ValueError(
            f"{source}: the force bends the tool by {1e6 * found.foreseen:.2g} µm rms, where the tracker saw "
            f"{1e6 * found.measured:.0f}: no force is measured, is its line connected?"
        )
    if not BENDS[0] <= found.slope <= BENDS[1] and abs(found.slope - 1.0) > SURE * found.deviation:
        raise ValueError(
            f"{source}: the tracker saw the tool bent by {found.slope:.3g} times what G_K makes of the force, must be "
            f"{BENDS[0]:g} to {BENDS[1]:g}: {_why(found, 'the force', 'G_K')}"
        )
    late, sure = lateness(bent, foreseen, rate, FAR, APART)
    if sure > SURELY_LATE:
        raise ValueError(
            f"{source}: the force is {late:.3g} s later than the tracker sees the tool bent by it, must be within "
            f"{APART:g} s: have they one clock?"
        )


def refuse_other_force(force: np.ndarray, foreseen: np.ndarray, rate: float, source: str) -> None:
    """Refuse, by ValueError, a force that is none, or other than G_M has it, where no tracker is a witness.

    Parameters
    ----------
    force, foreseen : arrays, shape (N, 3), N
        f, and G_M y_n, where the tool is in the material.
    rate : float, samples/s
    source : str
        What is told of: "force.csv".
    """
    found = agreement(force, foreseen, rate)
    if found.measured < LEAST * found.foreseen and abs(found.correlation) < ALIKE:
        raise ValueError(
            f"{source}: the force varies by {found.measured:.2g} N rms, where G_M foresees {found.foreseen:.2g}: no "
            "force is measured, is its line connected?"
        )
    if found.correlation < -ALIKE or (found.correlation > ALIKE and not CUTS[0] <= found.slope <= CUTS[1]):
        raise ValueError(
            f"{source}: the force is {found.slope:.3g} times what G_M foresees, must be {CUTS[0]:g} to {CUTS[1]:g}: "
            f"{_why(found, 'the force', 'G_M')}"
        )


LEAST_MOVED, LEAST_BENT = 2e-5, 5e-6
"""m rms, along an axis, and of what is bent: less than that tells nothing."""


def _why(found: Agreement, signal: str, model: str) -> str:
    """Return in words what the likely reason is."""
    told = f"correlation {found.correlation:.2f}"
    if abs(found.correlation) < ALIKE:
        return f"they have little in common ({told}): other axes, another clock, or {model} of another robot"
    if found.slope < 0:
        return f"{signal}'s sign appears reversed ({told}), or {model} is of another robot: calibrate again"
    return f"another unit of {signal}, or {model} of another robot ({told}): calibrate again"
