"""Position control beside force control: the same ports, and a feed that is given."""

import numpy as np

from ctlblocks.block import Block, Port


class ConstantFeed(Block):
    """Feed at a speed that `change` sets, reached with a limited acceleration, whatever the force.

    Ports as far as they make sense: `velocity` (m/s), `force` (N, 2), `is_valid`, `is_running` in; `reference` (m/s),
    `resultant` (N) and `phase`, which is `phase` of the constructor while it runs and 0 else, out.

    Parameters
    ----------
    acceleration : float, m/s^2, > 0
    phase : float
        What the port of that name shows.
    """

    inputs = (Port("velocity", "m/s"), Port("force", "N", 2), Port("is_valid"), Port("is_running"))
    outputs = (Port("reference", "m/s"), Port("resultant", "N"), Port("phase"))

    def __init__(self, acceleration: float, phase: float) -> None:
        self._acceleration, self._phase, self.feed = acceleration, phase, 0.0

    def prepare(self, rate: float, frames: int) -> None:
        """Stand still."""
        self._step, self._now = self._acceleration / rate, 0.0

    def change(self, feed: float) -> None:
        """Take another feed, m/s (between ticks); a ValueError unless that is a number > 0."""
        if not 0.0 < feed < np.inf:
            raise ValueError(f"feed is {feed} m/s, must be finite and > 0")
        self.feed = feed

    def process(
        self,
        velocity: np.ndarray,
        force: np.ndarray,
        is_valid: np.ndarray,
        is_running: np.ndarray,
        reference: np.ndarray,
        resultant: np.ndarray,
        phase: np.ndarray,
    ) -> None:
        """Fill one frame."""
        for n in range(len(velocity)):
            runs = is_running[n, 0] > 0.5
            self._now = min(self._now + self._step, self.feed) if runs else 0.0
            reference[n, 0], phase[n, 0] = self._now, self._phase if runs else 0.0
        np.hypot(force[:, :1], force[:, 1:], out=resultant)
