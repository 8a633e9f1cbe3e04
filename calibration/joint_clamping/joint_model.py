"""What a clamping experiment says of a joint: each figure with its standard error and confidence interval."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

Spring = Literal["piecewise linear", "smooth"]
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A figure and how well it is known.

    Parameters
    ----------
    value, error : float, the figure's unit
        The estimate and its standard error.
    reach : float, 1
        Half the width of the interval of `CONFIDENCE`, in standard errors.
    """

    value: float
    error: float
    reach: float

    @property
    def low(self) -> float:
        """The interval's lower end."""
        return self.value - self.reach * self.error

    @property
    def high(self) -> float:
        """The interval's upper end."""
        return self.value + self.reach * self.error

    @property
    def is_significant(self) -> bool:
        """Whether the interval lies above zero."""
        return self.low > 0


@dataclass(frozen=True)
class JointModel:
    """A joint's spring with backlash, and its friction.

    Parameters
    ----------
    spring : "piecewise linear" or "smooth"
        Smooth: torque = k x + k_cubic x^3 on either side, x from the edge of the backlash.
    backlash : Estimate, rad
        Lost motion; may come out negative where there is none.
    k_plus, k_minus : Estimate, N m/rad
        Stiffness on either side; of a smooth spring, at the edge of the backlash.
    cubic_plus, cubic_minus : Estimate, N m/rad^3
        0 for a piecewise linear spring.
    friction : Estimate, N m
        Half the loop's width where the spring bears nothing.
    friction_load : Estimate, 1
        What friction grows by per torque of the spring.
    presliding : float, rad
        Distance in which friction turns round after a reversal.
    centre : float, rad
        Middle of the backlash.
    offset : float, N m
        Torque there, mean of both directions.
    residual : float, N m
        Standard deviation of what the model leaves.
    torque_range : (float, float), N m
        That were used.
    cycles : float
        To and fro, that were used.
    has_backlash : bool
        Whether the backlash is significant; if not, the other figures are those of a spring without.
    """

    spring: Spring
    backlash: Estimate
    k_plus: Estimate
    k_minus: Estimate
    cubic_plus: Estimate
    cubic_minus: Estimate
    friction: Estimate
    friction_load: Estimate
    presliding: float
    centre: float
    offset: float
    residual: float
    torque_range: tuple[float, float]
    cycles: float
    has_backlash: bool

    @property
    def backlash_bound(self) -> float:
        """What the backlash does not exceed, rad: its size plus half the interval's width, whatever its sign."""
        return abs(self.backlash.value) + self.backlash.reach * self.backlash.error

    @property
    def loop_width(self) -> float:
        """Distance of the two directions, N m, where the spring bears nothing."""
        return 2 * self.friction.value

    @property
    def backlash_said(self) -> str:
        """The backlash in words, mrad."""
        if self.has_backlash:
            half = 1e3 * self.backlash.reach * self.backlash.error
            return f"{1e3 * self.backlash.value:.4f} ± {half:.4f} mrad"
        return f"not significant (< {1e3 * self.backlash_bound:.4f} mrad)"

    def spring_torque(self, angle: np.ndarray) -> np.ndarray:
        """Return the torque without friction, shape (samples,), N m, at angles, shape (samples,), rad."""
        twist, gap = angle - self.centre, self.backlash.value if self.has_backlash else 0.0
        up, down = np.maximum(twist - gap / 2, 0.0), np.minimum(twist + gap / 2, 0.0)
        rising = self.k_plus.value * up + self.cubic_plus.value * up**3
        falling = self.k_minus.value * down + self.cubic_minus.value * down**3
        found: np.ndarray = self.offset + rising + falling
        return found
