"""The simulated robot and a clamp for its tool as a block: the arm pushes against the clamp."""

from dataclasses import dataclass, field

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.options import option
from firmware_sim.plants.robot import STIFF_CLAMP, RobotPlant
from firmware_sim.plants.robot_options import RobotOptions

ANSWER = 0.1
"""s that soft servo and clamp take to answer."""


@dataclass(eq=False, kw_only=True)
class ClampedRobot(RobotOptions, Block):
    """The simulated robot, at rest at home after every `prepare`; `RobotPlant` says what it models.

    Ports: `reference` (rad), six wide, `soft` and `clamp` (1 for on) in; `angle` (rad) and `torque` (N m) of the
    motors, `link` (rad, true angles of the links), six wide, `pose` (of the tool: m and a unit quaternion), `softened`,
    `clamped` and `fault` (1 for yes; its torque supervision) out.

    In a loop, wire its inputs `delayed`: before the first references can come, in its first sample, it stays at home.

    Parameters
    ----------
    softness : tuple of float, 1
        Part of the position gain that soft servo takes away, a number a joint.
    clamp, clamp_turn : float, m/N and rad/(N m)
        The clamp's compliance along each axis and about it.
    slip : float, N
        Force beyond which the clamp slips.

    Others: those of `RobotOptions`.
    """

    softness: tuple[float, ...] = (0.85,) * 6
    clamp: float = option(float(STIFF_CLAMP[0, 0]), "m/N", 0.0, 1e-3)
    clamp_turn: float = option(float(STIFF_CLAMP[3, 3]), "rad/(N m)", 0.0, 1e-1)
    slip: float = option(1e9, "N", 1.0, 1e9)

    inputs: tuple[Port, ...] = field(
        default=(Port("reference", "rad", 6), Port("soft"), Port("clamp")), init=False, repr=False
    )
    outputs: tuple[Port, ...] = field(
        default=(
            Port("angle", "rad", 6),
            Port("torque", "N m", 6),
            Port("link", "rad", 6),
            Port("pose", "1", 7),
            Port("softened"),
            Port("clamped"),
            Port("fault"),
        ),
        init=False,
        repr=False,
    )

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest at home."""
        names = set(RobotOptions.__dataclass_fields__)
        self.plant = RobotPlant(rate=rate, **{name: getattr(self, name) for name in names})
        self._wrench = np.zeros((1, 6))
        self._waited, self._answer = np.zeros(2, np.int64), max(1, round(ANSWER * rate))
        self._is_soft = self._is_clamped = False
        self._held = np.zeros((1, 6))
        self._held[0], self._begun = self.plant.home, False

    def process(
        self,
        reference: np.ndarray,
        soft: np.ndarray,
        clamp: np.ndarray,
        angle: np.ndarray,
        torque: np.ndarray,
        link: np.ndarray,
        pose: np.ndarray,
        softened: np.ndarray,
        clamped: np.ndarray,
        fault: np.ndarray,
    ) -> None:
        """Run it over one frame."""
        for n in range(len(reference)):
            self._answer_to(soft[n, 0] >= 1.0, clamp[n, 0] >= 1.0)
            now = slice(n, n + 1)
            wanted = reference[now] if self._begun else self._held
            self._begun = True
            self.plant.run(wanted, self._wrench, angle[now], torque[now], link[now], pose[now])
            softened[n, 0], clamped[n, 0] = self._is_soft, self._is_clamped
            fault[n, 0] = self.plant.tripped > 0

    def _answer_to(self, soft: bool, clamp: bool) -> None:
        """Turn soft servo and clamp on or off after they were asked for so long."""
        self._waited[0] = self._waited[0] + 1 if soft != self._is_soft else 0
        self._waited[1] = self._waited[1] + 1 if clamp != self._is_clamped else 0
        if self._waited[0] >= self._answer:
            self._is_soft = soft
            self.plant.soften(np.array(self.softness if soft else (0.0,) * 6))
        if self._waited[1] >= self._answer:
            self._is_clamped = clamp
            if clamp:
                self.plant.clamp(np.diag([self.clamp] * 3 + [self.clamp_turn] * 3), self.slip)
            else:
                self.plant.release()
