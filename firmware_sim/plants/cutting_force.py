"""How hard a material is to cut: the coefficients of the mechanistic force model, as published."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class CuttingForce:
    """Force on a cutting edge of width b that takes a chip of thickness h: (cutting h + edge) b along each direction.

    Parameters
    ----------
    cutting : N/m^2, tangential, radial, axial: K_tc, K_rc, K_ac
    edge : N/m, K_te, K_re, K_ae

    Source
    ------
    Altintas, Manufacturing Automation, 2nd ed., sec. 2.8.
    """

    cutting: tuple[float, float, float]
    edge: tuple[float, float, float]

    @property
    def table(self) -> np.ndarray:
        """Rows cutting and edge, shape (2, 3), N/m^2 and N/m."""
        return np.array([self.cutting, self.edge])


MATERIALS = {
    "al7075": CuttingForce((767.01e6, 168.8e6, 222.0e6), (27.7e3, 26.6e3, 0.7e3)),
    "al7075-hss": CuttingForce((951.365e6, 262.597e6, 323.33e6), (11.115e3, 11.314e3, 1.105e3)),
    "al6082": CuttingForce((631.0e6, 99.0e6, 273.0e6), (13.0e3, 10.0e3, 2.8e3)),
}
"""Al7075-T6 by carbide, Al7075 by high-speed steel, Al6082-T6 by carbide, all dry: their rows in table 5 of a survey,
Milling Force Model for Aviation Aluminum Alloy, Chin. J. Mech. Eng. 34 (2021), doi:10.1186/s10033-021-00536-9, refs.
[190], [156] and [189] there."""
