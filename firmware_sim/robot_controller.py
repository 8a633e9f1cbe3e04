"""The robot's controller: guided motion 250 times a second around the simulated arm, and the program beside it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.robot_inverse import rigid_pose
from stagectl.wire.robot import RATE, Motion


@dataclass(frozen=True)
class GuidedMotion:
    """How guided motion is set up in the robot's program.

    Parameters
    ----------
    filter : float, Hz, of the first-order low-pass for what is asked for
    delay : int, cycles from a command to the servo; with the filter's, a lag of 10 to 20 ms
    speed : float, rad/s, fastest that a joint follows a command
    patience : float, s without a command after which guided motion stops
    farthest : float, rad, a command further away than this is an error
    """

    filter: float = 20.0
    delay: int = 2
    speed: float = 1.0
    patience: float = 1.0
    farthest: float = 0.35


class Cut(Protocol):
    """What the tool mills."""

    rate: float

    def run(
        self, tool: np.ndarray, give: np.ndarray, force: np.ndarray, moment: np.ndarray, teeth_force: np.ndarray
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        tool : array, shape (frames, 3), m
            Where the tip really is, in axes of the base.
        give : array, shape (frames, 9), m/N
            By what a force moves it at once, a 3 x 3 matrix row by row.
        force, moment, teeth_force : arrays, shape (frames, 3), N, N m and N, filled in place
            On the tool, averaged over a turn and with its teeth.
        """


@dataclass
class CommandCounts:
    """What became of the commands: taken, late or twice, garbled."""

    taken: int = 0
    late: int = 0
    garbled: int = 0


class WireEnd(Protocol):
    """What speaks a make's messages at the controller's end, cycle by cycle."""

    def take(self, data: bytes, robot: "RobotController") -> bool:
        """Take a datagram from the host; return whether it is a command, which it has passed on."""

    def look(self, robot: "RobotController") -> None:
        """Look at the time-out, before a cycle's motion."""

    def say(self, robot: "RobotController") -> bytes | None:
        """Return what is sent in this cycle, or None."""

    def begin(self, robot: "RobotController") -> None:
        """Begin where the robot is: guided motion was begun anew."""


class RobotController:
    """The controller without sockets: cycle by cycle, commands in, reports out.

    Modelled: position guidance by joints or pose with filter, delay and speed limit, and what its wire's end models.
    Not modelled: path correction, external axes, convergence, ramps at its start and end.

    Parameters
    ----------
    plant : RobotPlant, of 250 samples/s, or of as many as the cut
    setup : GuidedMotion
    clamp : array, shape (6, 6), m and rad per N and N m, compliance of what the clamp is fastened to
    slip_force : float, N, beyond which the clamp slips
    cut : Cut or None
        The block that the tool is in; its rate a multiple of 250 samples/s.
    fresh : callable() -> Cut, optional
        Makes the next block, of the same rate; only with `cut`.
    end : WireEnd
        Whose messages it speaks.
    """

    def __init__(
        self,
        plant: RobotPlant,
        setup: GuidedMotion | None = None,
        clamp: np.ndarray | None = None,
        slip_force: float = np.inf,
        cut: Cut | None = None,
        fresh: Callable[[], Cut] | None = None,
        *,
        end: WireEnd,
    ) -> None:
        rate = RATE if cut is None else cut.rate
        if plant.rate != rate:
            raise ValueError(f"the plant runs at {plant.rate:g} samples/s, must be {rate:g} for guided motion")
        self._cut, self._steps, self._pushed = cut, round(rate / RATE), np.zeros((3, 1, 3))
        self._fresh = fresh
        self._asked, self._part = plant.home.copy(), np.zeros((1, 6))
        self.plant, self.setup, self.counts = plant, setup or GuidedMotion(), CommandCounts()
        self.wrench = np.zeros((1, 6))
        self.torque, self.motor_angle = np.zeros((1, 6)), plant.home[None].copy()
        self.link_angle, self.pose = plant.home[None].copy(), np.zeros((1, 7))
        self.motion, self.cycle = Motion.RUNNING, 0
        self.is_mute = False
        self._clamp, self._slip_force = clamp, slip_force
        self.idle, self.has_command, self._end = 0, False, end
        self._line = np.tile(plant.home, (self.setup.delay + 1, 1))
        self._reference = plant.home.copy()
        end.begin(self)
        self._move()

    @property
    def time(self) -> float:
        """The controller's clock, s."""
        return self.cycle / RATE

    @property
    def reference(self) -> np.ndarray:
        """What the servo is asked for, shape (6,), rad."""
        return self._reference

    @property
    def asked(self) -> np.ndarray:
        """What was asked for last, before delay and filter, shape (6,), rad."""
        return np.asarray(self._line[0])

    @property
    def has_block(self) -> bool:
        """Whether there is something under the tool."""
        return self._cut is not None

    def receive(self, data: bytes) -> None:
        """Take a datagram from the host."""
        if self._end.take(data, self):
            self.counts.taken += 1
            self.idle, self.has_command = 0, True

    def advance(self) -> bytes | None:
        """Run one cycle and return the report; None while mute."""
        self.cycle += 1
        self.idle += 1
        if self.motion is Motion.RUNNING:
            self._end.look(self)
        if self.plant.tripped:
            self.stop(Motion.STOPPED)
        self._line[1:] = self._line[:-1].copy()
        pole = np.exp(-2 * np.pi * self.setup.filter / RATE)
        step = (1 - pole) * (self._line[-1] - self._reference)
        self._reference += np.clip(step, -self.setup.speed / RATE, self.setup.speed / RATE)
        self._move()
        return None if self.is_mute else self._end.say(self)

    def ask(self, wanted: np.ndarray) -> None:
        """Follow joint angles, shape (6,), rad, from now on; what is too far is an error, and nothing while stopped."""
        if self.motion is not Motion.RUNNING:
            return
        if np.abs(wanted - self._reference).max() > self.setup.farthest:
            self.stop(Motion.ERROR)
        else:
            self._line[0] = wanted

    def stop(self, motion: Motion) -> None:
        """Stand still where it is, as `motion` says."""
        if self.motion is Motion.RUNNING:
            self.motion = motion
            self._line[:] = self._reference

    def rigid_pose(self, angle: np.ndarray) -> np.ndarray:
        """Return where the rigid arm has the tool at joint angles, shape (6,), rad: shape (7,), m and 1."""
        return rigid_pose(self.plant, angle)

    def signal(self) -> str:
        """Return a line of the signal log: time (s), motor angles (deg), motor torques (N m)."""
        values = (self.time, *np.degrees(self.motor_angle[0]), *self.torque[0])
        return ",".join(f"{value:.9g}" for value in values)

    def do(self, line: str) -> str:
        """Do what a line of the program's own wire asks for, and return the answer: OK, or ERROR and why.

        SOFT and six numbers; CLAMP 1 or 0; BLOCK 1, a fresh one, or 0, none; RESET.
        """
        match line.split():
            case ["SOFT", *numbers]:
                return self._soften(numbers)
            case ["CLAMP", "1"]:
                if self._clamp is None:
                    self.plant.clamp(slip_force=self._slip_force)
                else:
                    self.plant.clamp(self._clamp, self._slip_force)
            case ["CLAMP", "0"]:
                self.plant.release()
            case ["BLOCK", "1" | "0" as given]:
                if self._fresh is None:
                    return "ERROR there is no changer for blocks"
                self._cut = self._fresh() if given == "1" else None
                self.wrench[:] = 0.0
            case ["RESET"]:
                self._reset()
            case _:
                return f"ERROR {line!r} is none of SOFT, CLAMP, BLOCK, RESET"
        return "OK"

    def _soften(self, numbers: list[str]) -> str:
        try:
            self.plant.soften(np.array([float(each) for each in numbers]))
        except ValueError as fault:
            return f"ERROR {fault}"
        return "OK"

    def _reset(self) -> None:
        self.plant.brake(False)
        self.motion, self.has_command = Motion.RUNNING, False
        self._reference = self.motor_angle[0].copy()
        self._line[:] = self._asked[:] = self._reference
        self._end.begin(self)

    def _move(self) -> None:
        outputs = self.motor_angle, self.torque, self.link_angle, self.pose
        step = (self._reference - self._asked) / self._steps
        give = self.plant.tilting_compliance()[:3, :3].reshape(1, 9)
        for k in range(self._steps):
            np.add(self._asked, (k + 1) * step, out=self._part[0])
            self.plant.run(self._part, self.wrench, *outputs)
            if self._cut is not None:
                self._cut.run(self.pose[:, :3], give, *self._pushed)
                self.wrench[:, :3], self.wrench[:, 3:] = self._pushed[:2]
        self._asked[:] = self._reference
