"""Runs of the cut tooth by tooth that several tests look at."""

from typing import Any

import numpy as np
from scipy.linalg import expm

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


def largest_multiplier(depth: float, mode: tuple[float, float, float], spindle: float, along: bool) -> float:
    """Return the largest Floquet multiplier of a slot by a tool that rings in one direction, by semi-discretization.

    First order, two teeth, linear law [Insperger and Stepan, Int. J. Numer. Meth. Eng. 55 (2002) 503].
    """
    frequency, damping, stiffness = mode
    omega, teeth, parts = 2 * np.pi * frequency, 2, 40
    mass, step = stiffness / omega**2, 1.0 / (spindle * teeth * parts)
    whole = np.eye(parts + 2)
    turned = 2 * np.pi * spindle * step * (np.arange(8 * parts) + 0.5) / 8
    x, y = (np.stack([wave(np.pi * tooth - turned) for tooth in range(teeth)]) for wave in (np.cos, np.sin))
    side = (-6e8 * y - 2e8 * x) * x if along else (6e8 * x - 2e8 * y) * y
    pushes = -depth * np.where(x > 0.0, side, 0.0).sum(axis=0).reshape(parts, 8).mean(axis=1)  # a slot along x
    for push in pushes:
        rate = np.array([[0.0, 1.0], [-(omega**2) - push / mass, -2 * damping * omega]])
        held = expm(np.block([[rate, np.array([[0.0], [push / mass]])], [np.zeros((1, 3))]]) * step)
        move = np.zeros((parts + 2, parts + 2))
        move[:2, :2] = held[:2, :2]
        move[:2, -2:] = 0.5 * held[:2, 2:]
        move[2, 0] = 1.0
        move[3:, 2:-1] = np.eye(parts - 1)
        whole = move @ whole
    return float(np.abs(np.linalg.eigvals(whole)).max())


def depth_limit(mode: tuple[float, float, float], spindle: float, along: bool) -> float:
    """Return the depth, m, from which on a slot chatters."""
    depths = np.geomspace(1e-4, 5e-3, 25)
    first = next(n for n, depth in enumerate(depths) if largest_multiplier(depth, mode, spindle, along) > 1.0)
    low, high = depths[first - 1], depths[first]
    for _ in range(5):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if largest_multiplier(middle, mode, spindle, along) > 1.0 else (middle, high)
    return float(low)
