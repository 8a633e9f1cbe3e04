"""Robots drawn by seed: how soft an arm is, what rubs in its joints, and how its controller follows."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from firmware_sim.plants.robot_arms import ARMS
from firmware_sim.plants.robot_draw import draw_joints
from firmware_sim.plants.robot_geometry_kernel import jacobians, place
from firmware_sim.plants.robot_joint_kernel import ACROSS_X, ACROSS_Y, STIFF_MINUS, STIFF_PLUS
from firmware_sim.plants.robot_options import RobotOptions
from firmware_sim.plants.tooth_cut import LOSS, ToolMode
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams

COMPLIANCE = 0.3, 3.0
"""1, of joints about their axes, and across them, over that of the arm's kind."""
FRICTIONS = ("coulomb", "stribeck", "loaded", "warming")
"""What rubs in the joints; each has what those before it have."""
FRICTION, STICTION, STRIBECK = (0.3, 3.0), (1.05, 1.8), (5e-3, 0.1)
"""1, 1 and rad/s."""
LOADED, COLD, WARMTH = (0.01, 0.1), (0.3, 2.0), (0.0, 1.0)
HEATING, COOLING = (0.1, 5.0), (300.0, 5_000.0)
"""1/kJ and s."""
BACKLASH, TIGHT = (0.2, 3.7), 0.2
"""Over 0.1 mrad, of which a joint has up to 1.35 times: 0.5 mrad at most; and part of the arms that have none."""
HARDENING, LINEAR = (0.2, 2.0), 0.5
"""1, growth of stiffness up to the torque limit, and part of the arms whose stiffness does not grow."""
GEAR_ERROR, NOISE = (0.3, 3.0), (0.5, 5.0)
FILTER, DELAY = (12.0, 30.0), (1, 4)
"""Hz and cycles, of guided motion."""
PAYLOAD = 2.0, 6.0
"""kg, of the spindle."""


@dataclass(frozen=True)
class DrawnRobot:
    """A robot, as keywords.

    Parameters
    ----------
    friction : str, of `FRICTIONS`
    arm : mapping
        Keywords of `RobotOptions`.
    guided : mapping
        Keywords of `GuidedRobot` beside those.
    """

    friction: str
    arm: dict[str, Any] = field(hash=False)
    guided: dict[str, Any] = field(hash=False)

    def compliance(self, home: tuple[float, ...], tool: float) -> np.ndarray:
        """Return that of the tool beyond all backlash at joint angles `home`, rad: shape (3, 3), m/N."""
        along, across = self._compliances(home, tool)
        whole: np.ndarray = along + across
        return whole

    def rings_at(self, home: tuple[float, ...], tool: float) -> np.ndarray:
        """Return where its spindle rings on what tilts across the axes, shape (3,), Hz, rising."""
        softness = np.linalg.eigvalsh(self._compliances(home, tool)[1])[::-1]
        return np.asarray(1.0 / (2 * np.pi * np.sqrt(self.arm["payload"] * softness)))

    def mode(self, home: tuple[float, ...], tool: float) -> ToolMode:
        """Return how its spindle rings in the plane, along the two directions in which that does not couple."""
        first, second = np.linalg.eigvalsh(self._compliances(home, tool)[1][:2, :2]).tolist()
        slow, fast = ((self.arm["payload"] * soft) ** -0.5 for soft in (second, first))
        hertz = slow / (2 * np.pi), fast / (2 * np.pi)
        return ToolMode(hertz, (0.5 * LOSS * slow, 0.5 * LOSS * fast), (1.0 / second, 1.0 / first))

    def _compliances(self, home: tuple[float, ...], tool: float) -> tuple[np.ndarray, np.ndarray]:
        """Return what joints give about their axes, and across them, shape (3, 3) each, m/N."""
        options = RobotOptions(**self.arm, tool=tool)
        kind = ARMS[options.arm]
        joints = draw_joints(np.random.default_rng(options.seed), kind, options)  # as `RobotPlant` begins
        frames, jacobian, across = np.zeros((8, 3, 4)), np.zeros((6, 6)), np.zeros((6, 12))
        place(np.array(home), np.zeros((6, 2)), kind.links, tool, frames)
        jacobians(frames, jacobian, across)
        about = 0.5 / joints[STIFF_PLUS] + 0.5 / joints[STIFF_MINUS]
        tilting = joints[[ACROSS_X, ACROSS_Y]].T.ravel()
        first, second = ((each * soft @ each.T)[:3, :3] for each, soft in ((jacobian, about), (across, tilting)))
        return first, second


def draw_robot(streams: Streams, seed: int) -> DrawnRobot:
    """Draw a robot of any kind of arm.

    Parameters
    ----------
    streams : Streams
    seed : int
    """
    friction = str(streams("friction").choice(FRICTIONS))
    arm = {
        "seed": seed,
        "compliance": _drawn(streams, "compliance", COMPLIANCE),
        "orthogonal": _drawn(streams, "orthogonal", COMPLIANCE),
        "backlash": _perhaps(streams, "backlash", BACKLASH, TIGHT),
        "hardening": _perhaps(streams, "hardening", HARDENING, LINEAR),
        "noise": _drawn(streams, "noise", NOISE),
        "payload": _drawn(streams, "payload", PAYLOAD),
        **_friction(streams, FRICTIONS.index(friction)),
    }
    guided = {
        "gear_error": _drawn(streams, "gear error", GEAR_ERROR),
        "filter": _drawn(streams, "filter", FILTER),
        "delay": int(streams("delay").integers(DELAY[0], DELAY[1] + 1)),
    }
    return DrawnRobot(friction, arm, guided)


def _friction(streams: Streams, kind: int) -> dict[str, float]:
    found = {"friction": _drawn(streams, "coulomb", FRICTION), "stiction": 1.0}
    if kind >= FRICTIONS.index("stribeck"):
        found["stiction"] = float(streams("stiction").uniform(*STICTION))
        found["stribeck"] = _drawn(streams, "stribeck", STRIBECK)
    if kind >= FRICTIONS.index("loaded"):
        found["load_friction"] = _drawn(streams, "loaded", LOADED)
    if kind >= FRICTIONS.index("warming"):
        found["cold"], found["warmth"] = _drawn(streams, "cold", COLD), float(streams("warmth").uniform(*WARMTH))
        found["heating"], found["cooling"] = _drawn(streams, "heating", HEATING), _drawn(streams, "cooling", COOLING)
    return found


def _drawn(streams: Streams, name: str, limits: tuple[float, float]) -> float:
    return float(log_uniform(streams(name), *limits))


def _perhaps(streams: Streams, name: str, limits: tuple[float, float], without: float) -> float:
    """Return nothing for a part of all machines, else a number within limits."""
    return 0.0 if streams(f"{name} at all").uniform() < without else _drawn(streams, name, limits)
