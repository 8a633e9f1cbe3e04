"""A drawn vibrator, of whichever family, as the rig file and the Block need it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.references import Respond, Wanted
from firmware_sim.population.streams import Streams

SENSITIVITY, LARGEST_DRIVE = (0.003, 3.0), 15.0
"""V per m/s^2, rms of the drive over that of the reference; and V rms at most."""
LEVEL = (0.5, 30.0)
"""m/s^2."""


class Plant(Protocol):
    """What runs."""

    def run(self, drive: np.ndarray, heard: np.ndarray) -> None:
        """Go on for `drive`, shape (frames, drives) V, and fill `heard`, shape (frames, sensors) m/s^2."""


@dataclass(frozen=True)
class Machine:
    """A vibrator and what was drawn.

    Parameters
    ----------
    build : callable(rate) -> Plant
        Makes it, at rest, at a rate, samples/s.
    respond : callable
        Its linear G at frequencies.
    widths : (int, int)
        Drives and sensors.
    rings, delay : float, s
        The slowest decay's time constant, and the longest delay.
    references : tuple of Wanted
        The vibrator's own first.
    level : float, m/s^2
        Of its own reference.
    quantities : tuple of Quantity
        What was drawn, but for what follows from level and limits.
    most : tuple of float, m/s^2
        The largest level of each reference that the machine is made for; empty: whichever the drive allows.
    """

    build: Callable[[float], Plant]
    respond: Respond
    widths: tuple[int, int]
    rings: float
    delay: float
    references: tuple[Wanted, ...]
    level: float
    quantities: tuple[Quantity, ...]
    most: tuple[float, ...] = ()


def draw_level(streams: Streams) -> tuple[float, float]:
    """Draw how much drive a reference needs, V per m/s^2 (rms over rms), and its level, m/s^2."""
    sensitivity = float(log_uniform(streams("sensitivity"), *SENSITIVITY))
    largest = float(np.sqrt(2)) * LARGEST_DRIVE / sensitivity
    level = float(log_uniform(streams("level"), LEVEL[0], min(LEVEL[1], largest)))
    return sensitivity, float(f"{level:.3g}")
