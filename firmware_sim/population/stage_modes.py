"""The modes of a stage, drawn by seed: how many, where, and how each moves stack and plate."""

import numpy as np

from firmware_sim.plants.flexure_stage import Modes
from firmware_sim.population.streams import Streams

COUNT, BAND = (2, 8), (40.0, 400.0)
"""Modes of an axis, and Hz between which they lie."""
FIRST = 40.0, 110.0
"""Hz, of the lowest."""
DAMPING = 0.003, 0.05
NEAR, NEARNESS = 0.4, (0.005, 0.05)
"""Of stages have a pair of modes on an axis, and how far apart those are."""
STRUCTURES = "collocated", "non-collocated", "mixed"
"""Whether modes move the plate in the sense of the first, in turn against it, or anyhow."""
GAUGED, RESIDUAL = (0.55, 0.87), (0.02, 0.1)
"""Of its free expansion a stack shows against the flexures by the modes, and at once."""
LEAD = 0.5
"""Of all that moves the plate at rest, at least, is what all modes together leave."""
STIFFNESS, SOFTEST = (30e6, 1e9), 0.6e-6
"""N/m of a stack, and m/N that the plate gives way at most at constant voltage; a stack is stiffer where it must be."""
COUPLING = 0.0, 0.05
"""Of an axis' motion another shows."""


def draw_modes(streams: Streams, lever: float) -> tuple[Modes, str]:
    """Draw the modes of three axes, and the structure of the path from stack to plate.

    Parameters
    ----------
    streams : Streams
    lever : float, 1
        What the plate moves for a free expansion of one; nearly, since axes are coupled.
    """
    structure = str(streams("structure").choice(STRUCTURES))
    parts = [_axis(streams.within(name), structure) for name in "xyz"]
    owner = np.repeat(range(3), [len(part[0]) for part in parts])
    frequency, damping, share, gauged = (np.concatenate([part[n] for part in parts]) for n in range(4))
    residual = np.array([streams.within(name)("residual").uniform(*RESIDUAL) for name in "xyz"])
    softness = lever**2 * np.bincount(owner, share**2 / gauged)
    least = np.maximum(STIFFNESS[0], softness / SOFTEST)
    stiffness = least * (np.maximum(STIFFNESS[1], 2 * least) / least) ** streams("stiffness").uniform()
    omega, k = 2 * np.pi * frequency, stiffness[owner]
    extension = omega * np.sqrt(gauged / k)
    plate = share * lever * omega / np.sqrt(gauged * k)
    coupling = streams("coupling").uniform(*COUPLING, (3, 3)) * streams("sides").choice([-1.0, 1.0], (3, 3))
    np.fill_diagonal(coupling, 1.0)
    own = np.eye(3)[:, owner]
    return Modes(frequency, damping, own * extension, coupling[:, owner] * plate, stiffness, residual), structure


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(low * (high / low) ** rng.uniform())


def _axis(streams: Streams, structure: str) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Draw frequency, damping, share of the plate's motion and of the gauge's, of an axis; shape (modes,) each."""
    count = int(streams("count").integers(COUNT[0], COUNT[1] + 1))
    rng, first = streams("frequency"), _log_uniform(streams("first"), *FIRST)
    above = 1.1 * first * (BAND[1] / (1.1 * first)) ** np.sort(rng.uniform(size=count - 1))
    frequency = np.concatenate([[first], above])
    near = streams("near")
    if near.uniform() < NEAR:
        low = int(near.integers(0, count - 1))
        frequency[low + 1] = min(frequency[low] * (1.0 + near.uniform(*NEARNESS)), frequency[low + 1])
    damping = DAMPING[0] * (DAMPING[1] / DAMPING[0]) ** streams("damping").uniform(size=count)
    size = streams("share").uniform(0.3, 1.0, count) * (frequency[0] / frequency) ** streams("fall").uniform(1.0, 2.5)
    sign = {
        "collocated": np.ones(count),
        "non-collocated": (-1.0) ** np.arange(count),
        "mixed": np.concatenate([[1.0], streams("sign").choice([-1.0, 1.0], count - 1)]),
    }[structure]
    share = sign * size
    share[0] += max(0.0, LEAD * size.sum() - share.sum())
    gauged = size * streams("gauge").uniform(0.5, 2.0, count)
    held = streams("held").uniform(*GAUGED)
    return frequency, damping, share / share.sum(), held * gauged / gauged.sum()
