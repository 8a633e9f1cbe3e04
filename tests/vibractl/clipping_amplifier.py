"""A vibrator behind an amplifier that goes no further."""

from typing import Any

import numpy as np

from firmware_sim.plant_blocks import Vibrator


class ClippingAmplifier(Vibrator):
    """The simulated vibrator, its first drives cut off at `top`, V.

    Ports: `drive` (V) in, `response` (m/s^2) out.
    """

    def __init__(self, top: float, coils: int = 2, **options: Any) -> None:
        super().__init__(**options)
        self._top, self._coils = top, coils

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Run it over one frame."""
        cut = drive.copy()
        cut[:, : self._coils] = np.clip(drive[:, : self._coils], -self._top, self._top)
        super().process(cut, response)
