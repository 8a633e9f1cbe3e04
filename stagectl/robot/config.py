"""The robot cell's file, `cell.toml`: robot, limits, tracker."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from rigkit.config import Section, code, keywords, setting
from rigkit.service.config import Daemon
from stagectl.link.config import Link
from stagectl.robot.clamp_config import Clamping
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.gears import refuse_coupling
from stagectl.robot.learning_config import ForceEstimation, Friction
from stagectl.robot.midranging_config import MidrangeConfig
from stagectl.robot.pocket_config import Learning, LearningChirp, Pocket
from stagectl.robot.segment_config import FeedPlants, SegmentTask
from stagectl.robot.toroid_config import Feedback, Plants, Six, Toroid
from stagectl.wire.makes import ROBOTS, TRACKERS, known

Box = tuple[float, float, float]
Constant = Annotated[float, Field(ge=-1e4, le=1e4)]
RobotMake = Annotated[str, AfterValidator(lambda name: known(name, ROBOTS))]
TrackerMake = Annotated[str, AfterValidator(lambda name: known(name, TRACKERS))]


class Rig(Section):
    """Which cell this is."""

    role = "wiring"

    name: str = setting("simulated-cell", "", "name of the cell, on its daemon's page and in its metrics", min_length=1)


class Robot(Section):
    """The robot's controller, which streams over UDP; it knows this computer's address and begins."""

    role = "patience"

    arm: str = setting(
        "irb140",
        "",
        "irb140, kuka, or a TOML file with an arm's geometry and limits",
        min_length=1,
        role="wiring",
        files=(".toml",),
    )
    wire: RobotMake = setting("egm", "", "egm, ABB's guided motion, or rsi, KUKA's sensor interface", role="wiring")
    tool: float = setting(0.1, "m", "from the flange along its axis to the tool point", ge=0, le=1, role="wiring")
    listen: str = setting("127.0.0.1", "", "this computer's address in the robot's network", min_length=1)
    port: int = setting(6510, "", "UDP port the robot sends to; 0 for any that is free", ge=0, le=65_535)
    address: str = setting(
        "", "", "the robot's own address; datagrams from others are ignored; empty: the first sender"
    )
    mode: Literal["joints", "pose"] = setting(
        "joints", "", "what is sent: joint angles, or the tool's pose", role="experiment"
    )
    silence: int = setting(
        3, "cycles", "cycles without a report from the robot, or without a reference, that are a fault", ge=1, le=250
    )
    late: int = setting(
        150_000, "cycles", "cycles without an answer in time after which the controller ends RSI", ge=1, le=2**31 - 1
    )
    lag: float = setting(0.05, "s", "a report delayed by so much re the fastest one is a fault", gt=0, le=10)
    patience: float = setting(2.0, "s", "time-out for the robot's first report", ge=0.05, le=60)
    commands: int = setting(
        6511, "", "TCP port of the robot's own program: soft servo, clamp; 0 for none", ge=0, le=65_535
    )
    signals: int = setting(6512, "", "TCP port of the motor torques; 0 for none", ge=0, le=65_535)
    torque_constant: tuple[Constant, Constant, Constant, Constant, Constant, Constant] = setting(
        (1.0,) * 6, "N m/A", "of each motor times its gear; over rsi torques are currents times these", role="wiring"
    )
    coupling: tuple[Six, ...] = setting(
        (),
        "",
        "J_m: how motors turn with joints, both seen from the arm's side of the gears, six rows of six numbers; "
        "empty where each turns its own joint alone",
        role="wiring",
    )
    height: float = setting(
        0.03,
        "m",
        "height over a workpiece at which the tool travels to its start, and waits",
        ge=5e-3,
        le=1,
        role="experiment",
    )
    travel: float = setting(
        0.05, "m/s", "speed of the tool on the way there, at most", gt=0, le=0.25, role="experiment"
    )
    changer: bool = setting(False, "", "its program changes workpieces, by BLOCK 1 and BLOCK 0; else a person does")

    @model_validator(mode="after")
    def _is_coupled_well(self) -> Self:
        refuse_coupling(self.coupling)
        return self

    @property
    def gear(self) -> np.ndarray:
        """J_m, shape (6, 6), 1: motors' angles = J_m x joint angles, both seen from the arm's side of the gears."""
        return np.array(self.coupling or np.eye(6))

    @property
    def is_whole(self) -> bool:
        """Whether torques and the program's outputs go over the robot's own wire."""
        return ROBOTS[self.wire]().is_whole

    @property
    def has_program(self) -> bool:
        """Whether something on the controller does what is asked for beside motion."""
        return bool(self.commands) or self.is_whole

    @property
    def has_torques(self) -> bool:
        """Whether motor torques come."""
        return bool(self.signals) or self.is_whole


class RobotLimits(Section):
    """Limits of every reference to the robot; beyond them the port holds the robot and reports why."""

    margin: float = setting(0.035, "rad", "distance from the arm's own joint limits", ge=0, le=1)
    speed: float = setting(0.1, "1", "part of the arm's own joint speeds", gt=0, le=1)
    correction: float = setting(1e-3, "m", "largest displacement of the tool by corrections", gt=0, le=5e-3)
    rotation: float = setting(5e-3, "rad", "largest rotation of the tool by corrections", gt=0, le=0.05)
    lowest: Box = setting((-1.0, -1.0, 0.0), "m", "corner of the box that the tool stays in, in the base")
    highest: Box = setting((1.0, 1.0, 1.5), "m", "the opposite corner")
    tool_speed: float = setting(0.25, "m/s", "of the tool", gt=0, le=5)
    turn_speed: float = setting(0.5, "rad/s", "of the tool's direction, where poses are sent", gt=0, le=10)
    stop: float = setting(0.1, "s", "in which a hold brings the references to rest", ge=0.004, le=2)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if not all(low < high for low, high in zip(self.lowest, self.highest, strict=True)):
            raise ValueError(f"limits.lowest is {self.lowest} m, must be below limits.highest {self.highest} m")
        return self


class Tracker(Section):
    """The optical tracker's gateway, TCP."""

    role = "patience"

    wire: TrackerMake = setting("gateway", "", "make of its protocol: gateway", role="wiring")
    host: str = setting("127.0.0.1", "", "its address", min_length=1)
    port: int = setting(6513, "", "its TCP port", ge=1, le=65_535)
    rate: float = setting(440.0, "samples/s", "it sends", gt=0, le=10_000)
    frame: int = setting(7, "", "number of the tracked frame: the tool's", ge=0, le=255, role="wiring")
    blind: float = setting(0.05, "s", "time without a valid pose of that frame that is a fault", gt=0, le=10)
    leds: int = setting(3, "", "smallest number of visible LEDs for a valid pose", ge=3, le=255)
    residual: float = setting(5e-4, "m", "largest rms residual of the LEDs of a valid pose", gt=0, le=0.01)
    jump: float = setting(
        5e-4, "m", "allowance for noise; a pose further off than this and `speed` allow is invalid", gt=0, le=0.1
    )
    speed: float = setting(0.05, "m/s", "largest speed of the tracked frame", gt=0, le=10)
    lag: float = setting(0.05, "s", "a sample delayed by so much re the fastest one is left out", gt=0, le=10)


class Simulator(Section):
    """The simulated robot; a live run does not read it."""

    role = "plant"

    options: dict[str, Any] = keywords("keywords the simulated robot is built with", "clamped", "plants.robot")
    clamped: str = code("firmware_sim.clamped_robot:ClampedRobot", "module:Class of its Block for `calibrate joints`")
    clamp: float = setting(2e-8, "m/N", "compliance of the clamp's mount along each axis", ge=0, le=1e-4)
    clamp_turn: float = setting(2e-7, "rad/(N m)", "and about each axis", ge=0, le=1e-2)
    slip: float = setting(5e3, "N", "force beyond which the clamp slips", gt=0, le=1e9)


class CellConfig(Section):
    """A whole file of the robot cell."""

    rig: Rig = Field(default_factory=Rig)
    robot: Robot = Field(default_factory=Robot)
    limits: RobotLimits = Field(default_factory=RobotLimits)
    tracker: Tracker = Field(default_factory=Tracker)
    force_sensor: ForceSensor = Field(default_factory=ForceSensor)
    link: Link = Field(default_factory=Link)
    midranging: MidrangeConfig = Field(default_factory=MidrangeConfig)
    clamping: Clamping = Field(default_factory=Clamping)
    simulator: Simulator = Field(default_factory=Simulator)
    toroid: Toroid = Field(default_factory=Toroid)
    feedback: Feedback = Field(default_factory=Feedback)
    plants: Plants = Field(default_factory=Plants)
    force: ForceFeed = Field(default_factory=ForceFeed)
    pocket: Pocket = Field(default_factory=Pocket)
    learning: Learning = Field(default_factory=Learning)
    friction: Friction = Field(default_factory=Friction)
    force_estimate: ForceEstimation = Field(default_factory=ForceEstimation)
    segments: SegmentTask = Field(default_factory=SegmentTask)
    feed_plants: FeedPlants = Field(default_factory=FeedPlants)
    chirp: LearningChirp = Field(default_factory=LearningChirp)
    daemon: Daemon = Field(default_factory=Daemon)
