"""Runs of the cut tooth by tooth that several tests look at."""

from typing import Any

import numpy as np

from firmware_sim.plants.hardness import Hardness
from firmware_sim.plants.tooth_cut import CuttingLaw, ToothCut, ToothCutPlant

RATE = 2_000.0
LINEAR = CuttingLaw((6e8, 2e8, 1e8), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
DEPTH, TOOL, SPINDLE = 1.5e-3, 6e-3, 150.0


def cut(**changes: Any) -> ToothCut:
    """Return a cut on rails in a block of 60 x 30 mm that is the same everywhere."""
    given: dict[str, Any] = {
        "law": LINEAR, "tool": TOOL, "wobble": (0.0, 0.0), "spindle": SPINDLE, "helix": 0.0, "mode": None, "mass": 3.0,
        "across": 0.0, "is_averaged": False, "hardness": Hardness(), "length": 60e-3, "width": 30e-3, "thickness": 6e-3,
        "cell": 2e-4, "layer": 5e-4, "origin": (0.0, 0.0, 0.0), "seed": 1,
    }  # fmt: skip
    return ToothCut(**(given | changes))


def path(feed: tuple[float, float], seconds: float, depth: float = DEPTH) -> np.ndarray:
    """Return where a tool goes at a feed (m/s), from within the block, shape (samples, 3), m."""
    time = np.arange(round(seconds * RATE)) / RATE
    start = -0.5 * seconds * np.array(feed)
    return np.column_stack([start + time[:, None] * feed, np.full(len(time), -depth)])


def run(made: ToothCut, tool: np.ndarray, give: np.ndarray | None = None) -> dict[str, np.ndarray]:
    """Return what the plant gives along a path, and how far the tool rings after each sample (m), by name."""
    names = {"force": 3, "moment": 3, "teeth_force": 3, "kappa": 1, "beta": 1}
    found = {name: np.zeros((len(tool), width)) for name, width in names.items()}
    plant, gives = ToothCutPlant(RATE, made), np.zeros((len(tool), 9)) if give is None else give
    ringing = np.zeros((len(tool), 2))
    for n in range(len(tool)):
        now = slice(n, n + 1)
        plant.run(tool[now], gives[now], *(found[name][now] for name in names))
        ringing[n] = plant.ringing
    return found | {"ringing": ringing}
