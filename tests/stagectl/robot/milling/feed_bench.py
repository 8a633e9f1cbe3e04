"""Force control against a workpiece of (7.4), for tests."""

from typing import Any

import numpy as np

from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_force import PHASES, FeedForce
from stagectl.robot.milling.nominal_velocity import nominal_velocity

H = 0.004
NOISE = 0.01
"""N: a sensor that shows the same twice is stuck."""
MODEL = nominal_velocity(250.0)


class Bench:
    """The block against a workpiece of (7.4), which begins somewhere before the tool."""

    def __init__(self, ahead: float = 0.0, **settings: Any) -> None:
        self.block = FeedForce(ForceFeed(**settings), MODEL)
        self.block.prepare(250.0, 1)
        self.outputs = {port.name: np.zeros((1, port.width)) for port in self.block.outputs}
        self.kappa, self.beta, self.stiffness, self.gap = 4e-4, 0.5, 75e3, ahead
        self.place = self.removed = self.velocity = 0.0
        self._state = np.zeros(MODEL.order)
        self.force, self.rng, self.noise, self.pull = np.zeros(2), np.random.default_rng(1), NOISE, 1.0

    def run(self, seconds: float, valid: float = 1.0, running: float = 1.0, force: float | None = None) -> np.ndarray:
        """Go on; return phase, feed wanted and resultant force, shape (samples, 3)."""
        told = []
        for _ in range(round(seconds / H)):
            seen = (self.force if force is None else np.array([force, 0.0])) + self.noise * self.rng.standard_normal(2)
            self.block.process(np.array([[self.velocity]]), seen[None], np.array([[valid]]), np.array([[running]]),
                               *self.outputs.values())  # fmt: skip
            self._move(self.of("reference"))
            told.append([self.of("phase"), self.of("wanted"), self.of("resultant")])
        return np.array(told)

    def of(self, name: str) -> float:
        return float(self.outputs[name][0, 0])

    @property
    def phase(self) -> str:
        return PHASES[int(self.of("phase"))]

    def _move(self, asked: float) -> None:
        self.velocity = float((MODEL.C @ self._state)[0])
        self._state = MODEL.A @ self._state + MODEL.B[:, 0] * asked * self.pull
        before = max(self.place - self.gap - self.removed, 0.0)
        self.place += H * self.velocity
        depth = max(self.place - self.gap - self.removed, 0.0)
        if before > 0.0 and depth > 0.0:  # f' = K_f (v - kappa f), exactly
            decay = self.kappa * self.stiffness * H
            depth = before - np.expm1(-decay) * (H * self.velocity / decay - before)
            self.removed = self.place - self.gap - depth
        along = self.stiffness * depth
        self.force = np.array([along, self.beta * along])
