"""The simulated piezo stage with a sensor that can stick."""

import math

import numpy as np

from firmware_sim.stage_blocks import PiezoStage


class StickingStage(PiezoStage):
    """The simulated piezo stage, whose capacitive sensor on y can stick."""

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest and in order."""
        super().prepare(rate, frames)
        self.stuck_at = math.nan

    def process(
        self,
        voltage: np.ndarray,
        force: np.ndarray,
        base: np.ndarray,
        extension: np.ndarray,
        position: np.ndarray,
        absolute: np.ndarray,
    ) -> None:
        """Run it over one frame."""
        self.plant.run(voltage, force, base, extension, position, absolute)
        if not math.isnan(self.stuck_at):
            position[:, 1] = self.stuck_at
