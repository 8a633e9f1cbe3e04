"""The simulated robot under guided motion as a block: what stands behind the robot port, without its socket."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ctlblocks.block import Block, Port
from firmware_sim.plants.gear_error import draw_gear_error
from firmware_sim.plants.guided_motion_kernel import MOTION, guide
from firmware_sim.plants.options import chosen, option
from firmware_sim.plants.robot import RobotPlant
from firmware_sim.plants.robot_options import RobotOptions
from firmware_sim.robot_controller import GuidedMotion

CYCLE = 0.004
"""s, of guided motion."""
NEVER = 1e9
"""s, when nothing happens."""


@dataclass(eq=False, kw_only=True)
class GuidedRobot(RobotOptions, Block):
    """A robot that follows references given 250 times a second; at rest at `start` after every `prepare`.

    `RobotPlant` says what it models; its gears have the errors of `draw_gear_error` as well.  Guided motion is that of
    `GuidedMotion`: delay, low-pass, speed limit.

    Ports: `reference` (rad, 6), `force` (N, 3) and `moment` (N m, 3) on the tool in base axes in; `report` (1), how
    many it has sent, `motors` (1 while they are on), `motor_angle`, `planned_angle` (rad, 6) as reported, and of the
    tool `position` (m, 3) and `orientation` (1, 4), a unit quaternion w x y z, the motors' `torque` (N m, 6), its mean
    from report to report, seen from the arm's side of the gears, and `give` (m/N, 9), by what a force moves the tool at
    once, a 3 x 3 matrix row by row, out.  Reports come every 4 ms.

    Parameters
    ----------
    gear_error : float, 1
        Scales the gears' errors.
    filter : float, Hz, corner of guided motion's low-pass
    delay : int, cycles, of guided motion
    start : sequence of float, rad, 6 joints; none for the arm's home
    mute : float, s, when it begins to be silent
    mute_for : float, s
    trip : float, s, when torque supervision puts the brakes on
    run : int
        Which run of the same arm: from 1 on the sensors' noise is another.

    Others: those of `RobotOptions`.
    """

    gear_error: float = option(1.0, "1", 0.0, 10.0)
    filter: float = option(GuidedMotion.filter, "Hz", 1.0, 100.0)
    delay: int = option(GuidedMotion.delay, "", 0, 25)
    start: Sequence[float] = ()
    mute: float = option(NEVER, "s", 0.0)
    mute_for: float = option(0.02, "s", 0.0)
    trip: float = option(NEVER, "s", 0.0)
    run: int = option(0, "", 0)

    def __post_init__(self) -> None:
        """Refuse what is out of range, and lay out the ports."""
        super().__post_init__()
        self.inputs = (Port("reference", "rad", 6), Port("force", "N", 3), Port("moment", "N m", 3))
        self.outputs = (
            Port("report"), Port("motors"), Port("motor_angle", "rad", 6), Port("planned_angle", "rad", 6),
            Port("position", "m", 3), Port("orientation", "1", 4), Port("torque", "N m", 6), Port("give", "m/N", 9),
        )  # fmt: skip

    def prepare(self, rate: float, frames: int) -> None:
        """Put it at rest where it starts."""
        self.plant = RobotPlant(rate=rate, **chosen(self, RobotOptions))
        if self.run:
            self.plant.renew_noise(self.run)
        start = np.array(self.start, float) if len(self.start) else self.plant.home
        gears = draw_gear_error(self.seed, self.gear_error)
        self.plant.place(start + (gears[:, 0] * np.sin(gears[:, 1] * start + gears[:, 2])).sum(axis=0))
        line = np.tile(start, (max(1, round(self.delay * CYCLE * rate)), 1))
        motion = np.array([(np.exp(-2 * np.pi * self.filter / rate), GuidedMotion.speed / rate, 0, start)], MOTION)
        self._guided = line, gears, motion
        self._room = [np.zeros((frames, width)) for width in (6, 6, 6, 6, 6, 6, 6, 7)]
        self._cycle, self._period, self._done = round(CYCLE * rate), 1.0 / rate, 0
        self._last, self._reports, self._on, self._trips = np.zeros((3, 6)), 0.0, 1.0, round(self.trip * rate)
        self._last[:2] = start
        self._drive, self._drives, self._mean = np.zeros(6), 0, np.zeros(6)
        self._give = np.zeros(9)

    def process(
        self,
        reference: np.ndarray,
        force: np.ndarray,
        moment: np.ndarray,
        report: np.ndarray,
        motors: np.ndarray,
        motor_angle: np.ndarray,
        planned_angle: np.ndarray,
        position: np.ndarray,
        orientation: np.ndarray,
        torque: np.ndarray,
        give: np.ndarray,
    ) -> None:
        """Go on for one frame."""
        driven, planned, error, wrench, angle, drive, link, pose = self._room
        guide(reference, driven, planned, error, *self._guided)
        wrench[:, :3], wrench[:, 3:] = force, moment
        n = 0
        while n < len(reference):  # from report to report
            now = slice(n, min(len(reference), n + self._cycle - self._done % self._cycle))
            if self._done % self._cycle == 0:
                self._on = float(not self.plant.tripped)
                self._give[:] = self.plant.tilting_compliance()[:3, :3].ravel()
                if self._done <= self._trips < self._done + self._cycle:
                    self.plant.trip(1)
            self.plant.run(driven[now], wrench[now], angle[now], drive[now], link[now], pose[now])
            mean = self._mean_torque(drive[now])
            if self._done % self._cycle == 0 and not self._is_mute(self._done * self._period):
                np.subtract(angle[n], error[n], out=self._last[0])
                self._last[1], self._last[2], self._reports = planned[n], mean, self._reports + 1.0
            report[now], motors[now] = self._reports, self._on
            motor_angle[now], planned_angle[now], torque[now] = self._last
            give[now] = self._give
            self._done += now.stop - n
            n = now.stop
        position[:], orientation[:] = pose[:, :3], pose[:, 3:]

    def _mean_torque(self, drive: np.ndarray) -> np.ndarray:
        """Return the mean up to the last report (N m); torques `drive`, (samples, 6), may begin with another.

        References come in steps, whose ripple every single sample after a report would show alike.
        """
        if self._done % self._cycle == 0:
            self._mean = (self._drive + drive[0]) / (self._drives + 1)
            self._drive[:], self._drives, drive = 0.0, 0, drive[1:]
        self._drive += drive.sum(axis=0)
        self._drives += len(drive)
        return self._mean

    def _is_mute(self, time: float) -> bool:
        return self.mute <= time < self.mute + self.mute_for
