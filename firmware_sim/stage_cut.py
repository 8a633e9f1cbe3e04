"""The cut that disturbs the simulated stage behind its wire: it begins when somebody begins it."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.stage_blocks import Milling


@dataclass(eq=False, kw_only=True)
class Cut(Milling):
    """A cut from its beginning after every `begin`; nothing before, and after `end`.

    Ports, three wide, x y z: `force` (N, on the stage's plate) and `base` (m, of the robot) out.

    Parameters: those of `Milling`.
    """

    def prepare(self, rate: float, frames: int) -> None:
        """Draw the cut; nothing mills yet."""
        super().prepare(rate, frames)
        self._made, self._is_on = (rate, frames), False

    def process(self, force: np.ndarray, base: np.ndarray) -> None:
        """Go on for one frame."""
        if self._is_on:
            super().process(force, base)
            return
        force.fill(0.0)
        base.fill(0.0)

    def begin(self) -> None:
        """Mill, from the beginning (between ticks)."""
        self.prepare(*self._made)
        self._is_on = True

    def end(self) -> None:
        """Mill no longer (between ticks): the robot is back at once, as the stage is not watched."""
        self._is_on = False
