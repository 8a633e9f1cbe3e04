"""A simulated six-joint robot: drives, gears with backlash and friction, elastic joints, and what may hold its tool."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.robot_arms import ARMS
from firmware_sim.plants.robot_draw import draw_joints, draw_links, tune_servo
from firmware_sim.plants.robot_geometry_kernel import place
from firmware_sim.plants.robot_joint_kernel import (
    ACROSS_X,
    ACROSS_Y,
    CELLS,
    GRAVITY_MODEL,
    INTEGRAL,
    LINK,
    LINK_SPEED,
    MOTOR,
    MOTOR_SPEED,
    SOFT,
    TORQUE_LIMIT,
    WANTED,
    WARMTH,
    spring,
)
from firmware_sim.plants.robot_kernel import (
    BRAKE,
    CLAMPED,
    PHASE,
    REFRESH,
    SLIP_FORCE,
    SLIPPED,
    STEP,
    TRIPPED,
    Parts,
    refresh,
)
from firmware_sim.plants.robot_options import RobotOptions
from firmware_sim.plants.robot_run_kernel import ARM, run_arm

FASTEST = 8_000.0
"""Steps/s within."""
GEOMETRY_PERIOD = 1e-3
"""s between two looks at the configuration."""
ANGLE_NOISE, TORQUE_NOISE = 1e-6, 1e-3
"""rad rms of the motors' resolvers behind the gears; rms of the torque signal over the torque limit."""
STIFF_CLAMP = np.diag([2e-8] * 3 + [2e-7] * 3)
"""m/N and rad/(N m): bolted to a steel plate."""


@dataclass(eq=False)
class RobotPlant(RobotOptions):
    """Angle references and a wrench at the tool in; motor angles, motor torques, link angles and the tool's pose out.

    Each motor turns its link through a gear with backlash, a spring that differs by direction and may harden, and
    damping; its friction is Coulomb, Stribeck and viscous with presliding.  Links are rigid bodies with gravity,
    centrifugal and Coriolis loads.  Joints are soft across their axes, too: there the load of gravity, tool wrench and
    clamp tilts them.  Stiffness and modes therefore change with configuration.  The servo is P on motor angle, PI on
    motor speed and a model of gravity with an error of its own; soft servo takes the integral and part of the P gain
    away; torque supervision puts the brakes on.  Motor angle and torque are seen from the arm's side of the gear.

    It does not model: links that bend, gears whose error repeats with the angle, motors that turn other joints, inertia
    of what tilts across the axes, current loops and inverters; friction that depends on load and temperature only where
    its options ask for it.

    Parameters
    ----------
    rate : float, samples/s, 50 to 8000, a whole part of 8000

    Others: those of `RobotOptions`.

    Source
    ------
    Sörnmo 2015, ch. 4, for the joint; Spong, ASME J. Dyn. Syst. Meas. Control 109 (1987) 310, for motor and link.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float = 250.0

    def __post_init__(self) -> None:
        """Draw it, at rest at home, holding itself up."""
        super().__post_init__()
        steps = FASTEST / self.rate if self.rate > 0 else 0.0
        if not (50 <= self.rate <= FASTEST and steps == round(steps)):
            raise ValueError(f"rate is {self.rate!r} samples/s, must be 50 to 8000 and 8000 a multiple of it")
        rng, arm = np.random.default_rng(self.seed), ARMS[self.arm]
        joints, links = draw_joints(rng, arm, self), draw_links(rng, arm, self)
        self.home = np.deg2rad(arm.home)
        tune_servo(joints, links, self.home, self.tool)
        self._parts = _parts(links, joints)
        self._parts.switches[STEP] = 1 / FASTEST
        self._parts.switches[REFRESH] = round(GEOMETRY_PERIOD * FASTEST)
        self._parts.switches[SLIP_FORCE] = np.inf
        self._shown, self._arm = np.zeros((8, 3, 4)), np.zeros(1, ARM)
        self._arm["steps"], self._arm["tool"] = round(steps), self.tool
        self._arm["angle_noise"] = self.noise * ANGLE_NOISE
        self._arm["torque_noise"] = self.noise * (TORQUE_NOISE * joints[TORQUE_LIMIT])
        self._random = rng.integers(1, 2**63, 1, np.uint64)
        self.place(self.home)

    def place(self, angle: np.ndarray) -> None:
        """Put it at rest at motor angles `angle` (rad), shape (6,), holding itself up; free, stiff, brakes off."""
        parts = self._parts
        parts.state[:], parts.soft[:] = 0.0, 0.0
        for switch in (BRAKE, TRIPPED, CLAMPED, PHASE, SLIPPED):
            parts.switches[switch] = 0.0
        parts.state[[MOTOR, LINK, WANTED]], self._arm["last"] = angle, angle
        parts.state[WARMTH] = self.warmth
        for _ in range(20):  # each joint yields until its gear bears the load, which moves with it
            refresh(np.zeros(6), self.tool, parts)
            load = -parts.moment[:, 2]
            parts.state[LINK] = angle - [_wind_up(joint, load[joint], parts.joints) for joint in range(6)]
        parts.state[INTEGRAL] = (1 - parts.joints[GRAVITY_MODEL]) * load
        self._arm["held"] = load
        place(parts.state[LINK], parts.tilt, parts.links, self.tool, self._shown)

    def renew_noise(self, run: int) -> None:
        """Draw the sensors' noise of another run of the same arm."""
        self._random[:] = np.random.default_rng([self.seed, 1, run]).integers(1, 2**63, 1, np.uint64)

    def run(
        self,
        reference: np.ndarray,
        wrench: np.ndarray,
        motor_angle: np.ndarray,
        torque: np.ndarray,
        link_angle: np.ndarray,
        pose: np.ndarray,
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        reference : array, shape (frames, 6), rad, for the motors
        wrench : array, shape (frames, 6), N and N m on the tool, in base axes
        motor_angle, torque, link_angle : arrays, shape (frames, 6), rad, N m and rad, filled in place
        pose : array, shape (frames, 7), filled in place
            Of the tool in the base: position (m), then the unit quaternion w x y z.
        """
        told = motor_angle, torque, link_angle, pose
        run_arm(reference, wrench, told, self._parts, self._shown, self._arm, self._random)

    @property
    def frames(self) -> np.ndarray:
        """Base, links 1 to 6 and tool as they are: rotation and origin (m) in the base, shape (8, 3, 4)."""
        return self._shown

    @property
    def joints(self) -> np.ndarray:
        """The truth about the joints, rows as in `robot_joint_kernel`, shape (ROWS, 6), SI units."""
        return self._parts.joints

    @property
    def links(self) -> np.ndarray:
        """The truth about the links, rows as in `robot_geometry_kernel`, shape (7, 9), rad, m and kg."""
        return self._parts.links

    @property
    def state(self) -> np.ndarray:
        """The truth about angles and speeds, rows as in `robot_joint_kernel`, shape (CELLS, 6), SI units."""
        return self._parts.state

    @property
    def tripped(self) -> int:
        """The joint, from 1, whose torque supervision has put the brakes on; 0 for none."""
        return int(self._parts.switches[TRIPPED])

    @property
    def slipped(self) -> float:
        """How far the clamp has slipped, m."""
        return float(self._parts.switches[SLIPPED])

    def soften(self, softness: np.ndarray) -> None:
        """Turn joints soft: the part of the P gain that is taken away, shape (6,), 0 to 0.99; 0 for stiff."""
        if not (np.shape(softness) == (6,) and np.all((np.asarray(softness) >= 0) & (np.asarray(softness) <= 0.99))):
            raise ValueError(f"softness is {softness}, must be 6 numbers from 0 to 0.99")
        soft = self._parts.soft
        soft[1] = np.asarray(softness) > 0
        soft[0] = np.where(soft[1] > 0, softness, soft[0])  # one that turns stiff does so from where it was

    def clamp(self, compliance: np.ndarray = STIFF_CLAMP, slip_force: float = np.inf) -> None:
        """Hold the tool where it is.

        Parameters
        ----------
        compliance : array, shape (6, 6), m and rad per N and N m
            Of what holds it, in base axes, positive semidefinite.
        slip_force : float, N, beyond which it slips
        """
        compliance = np.asarray(compliance, float)
        right = compliance.shape == (6, 6) and np.allclose(compliance, compliance.T)
        if not (right and np.linalg.eigvalsh(compliance).min() >= 0 and slip_force > 0):
            raise ValueError("compliance must be a symmetric, positive semidefinite 6x6 matrix, slip_force > 0 N")
        self._parts.environment[:] = compliance + 1e-12 * np.eye(6)
        self._parts.anchor[:] = 0.0
        self._parts.anchor[2:5, :4] = self._shown[7]
        self._parts.switches[[CLAMPED, SLIP_FORCE, SLIPPED]] = 1.0, slip_force, 0.0

    def release(self) -> None:
        """Let go of the tool."""
        self._parts.switches[CLAMPED] = 0.0
        self._parts.anchor[:] = 0.0

    def brake(self, on: bool) -> None:
        """Put the brakes on, or off: then it holds where it is, and a tripped supervision is forgotten."""
        parts = self._parts
        parts.switches[BRAKE] = float(on)
        if not on:
            parts.switches[TRIPPED] = 0.0
            parts.state[WANTED] = self._arm["last"] = parts.state[MOTOR]
            parts.state[SOFT] = parts.soft[1]

    def trip(self, joint: int) -> None:
        """Let torque supervision put the brakes on for a joint, 1 to 6."""
        self._parts.switches[TRIPPED] = joint

    def energy(self) -> float:
        """Return the kinetic energy of links and motors, J."""
        state, mass = self._parts.state, self._parts.frozen[:, :6]
        motors = self._parts.joints[5] @ state[MOTOR_SPEED] ** 2
        return float(0.5 * (state[LINK_SPEED] @ mass @ state[LINK_SPEED] + motors))

    def natural_frequencies(self) -> np.ndarray:
        """Return those of the links on their gears as loaded now, motors held, shape (6,), Hz, rising."""
        parts = self._parts
        stiffness = self._tangents() + parts.frozen[:, 12:18]
        squares = np.linalg.eigvals(np.linalg.solve(parts.frozen[:, :6], stiffness)).real
        return np.sort(np.sqrt(np.maximum(squares, 0.0))) / (2 * np.pi)

    def tool_compliance(self) -> np.ndarray:
        """Return that of the free tool as loaded now, motors held, shape (6, 6), m and rad per N and N m."""
        parts = self._parts
        along = parts.jacobian @ np.linalg.solve(self._tangents(), parts.jacobian.T)
        return np.asarray(along + self.tilting_compliance())

    def tilting_compliance(self) -> np.ndarray:
        """Return the part of it that has no mass, what tilts across the axes, shape (6, 6), m and rad per N and N m."""
        across, soft = self._parts.across, self._parts.joints[[ACROSS_X, ACROSS_Y]].T.ravel()
        return np.asarray((across * soft) @ across.T)

    def _tangents(self) -> np.ndarray:
        state = self._parts.state
        return np.diag([spring(i, state[MOTOR, i] - state[LINK, i], self._parts.joints)[1] for i in range(6)])


def _parts(links: np.ndarray, joints: np.ndarray) -> Parts:
    shapes = {
        "state": (CELLS, 6), "soft": (2, 6), "switches": (8,), "frames": (8, 3, 4), "centre": (7, 3),
        "jacobian": (6, 6), "across": (6, 12), "moment": (6, 3), "frozen": (6, 23), "anchor": (5, 6),
        "environment": (6, 6), "tilt": (6, 2), "wrench": (6,), "work": (6, 10),
    }  # fmt: skip
    return Parts(links=links, joints=joints, **{name: np.zeros(shape) for name, shape in shapes.items()})


def _wind_up(joint: int, load: float, joints: np.ndarray) -> float:
    """Return the angle, rad, at which a gear bears `load`, N m, by Newton's method."""
    half = 0.5 * joints[2, joint]
    angle = np.sign(load) * (half + abs(load) / joints[0, joint])
    for _ in range(30):
        torque, slope = spring(joint, angle, joints)
        if slope == 0.0:
            break
        angle += (load - torque) / slope
    return float(angle)
