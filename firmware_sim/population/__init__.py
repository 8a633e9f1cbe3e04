"""Machines drawn by seed, in families that differ in structure: as Blocks for a rig file's `[simulator]`.

`firmware_sim.population:Vibrator` and its likes are loaded when they are asked for: what draws one kind imports
nothing of the others.
"""

from importlib import import_module
from typing import Any

_BLOCKS: dict[str, str] = {
    "ClampedArm": "firmware_sim.population.cell_blocks",
    "Cut": "firmware_sim.population.cell_blocks",
    "ForceSensor": "firmware_sim.population.cell_blocks",
    "Pair": "firmware_sim.population.pair_block",
    "Robot": "firmware_sim.population.cell_blocks",
    "Stage": "firmware_sim.population.stage_block",
    "Tracker": "firmware_sim.population.cell_blocks",
    "Vibrator": "firmware_sim.population.vibrators",
}
"""Block -> its module."""


def __getattr__(name: str) -> Any:
    """Return a Block of the population by name, importing its module."""
    if name not in _BLOCKS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_BLOCKS[name]), name)


def __dir__() -> list[str]:
    """Return the Blocks that there are."""
    return sorted(_BLOCKS)
