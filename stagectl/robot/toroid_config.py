"""The tables of the robot cell's file that milling the toroid reads: the path, the feedback, and the simulated cell."""

from typing import Annotated, Any

from pydantic import Field

from rigkit.config import Section, code, keywords, setting

Positive = Annotated[float, Field(gt=0, le=200)]
Three = tuple[Positive, Positive, Positive]
Six = tuple[float, float, float, float, float, float]


class Toroid(Section):
    """The toroid: the robot holds the workpiece and moves it around a tool along x, in a circle in y and z."""

    arm: str = setting("kuka", "", "the arm that holds the workpiece, as robot.arm", min_length=1, files=(".toml",))
    home: Six = setting((0.0, -0.17453, 0.17453, 0.0, 0.5236, 0.0), "rad", "its joints, the tool in the middle")
    radius: float = setting(35e-3, "m", "of the path, half the toroid's mid-diameter", ge=5e-3, le=0.2)
    feed: float = setting(5e-3, "m/s", "along the path", ge=1e-3, le=0.05)
    turn: float = setting(1.0, "", "part of the circle that is milled", gt=0, le=1)
    lead: float = setting(2.5, "s", "before the path: time to settle and for the touch-off", ge=1, le=60)
    ramp: float = setting(0.5, "s", "duration of the ramp of the feed at start and end", gt=0, le=10)
    workpiece: float = setting(20.0, "kg", "with its fixture", ge=0, le=200)
    margin: float = setting(0.02, "m", "largest distance of the workpiece from its path", gt=0, le=0.5)


class Feedback(Section):
    """Feedback from the tracker to robot and stage."""

    corner: Three = setting((1.5, 1.5, 1.5), "Hz", "of each of the two low-passes for the tracker, for x, y and z")
    laser: bool = setting(
        True, "", "setup C: a laser on the stage measures the distance to the workpiece's face, along x"
    )
    laser_corner: float = setting(
        0.05, "Hz", "of the low-passes for the tracker along x, beside the laser", gt=0, le=10
    )
    delay: float = setting(0.004, "s", "delay of the tracker re the stage's sensors", ge=0, le=0.1)
    lag: float = setting(0.03, "s", "lag of the robot re its reference", ge=0, le=1)
    robot_model: float = setting(0.1, "s", "time constant of the robot, tracker and low-pass", gt=0, le=10)
    robot: float = setting(0.5, "s", "closed-loop time constant of the robot's correction, setup B", gt=0, le=100)
    stage_model: float = setting(0.005, "s", "time constant of the stage's closed loops", gt=0, le=1)
    stage: Three = setting(
        (0.03, 0.05, 0.05), "s", "closed-loop time constant of the stage's correction, setup C, for x, y and z"
    )
    takeover: float = setting(0.5, "s", "time constant with which the robot takes over from the stage", gt=0, le=100)
    orientation: float = setting(
        2.0,
        "s",
        "time constant with which the robot corrects the workpiece's orientation, setups B and C; 0: never",
        ge=0,
        le=100,
    )
    saturated: float = setting(0.5, "s", "time of the stage at an end of its travel that is a fault", gt=0, le=1e3)


class Plants(Section):
    """The simulated cell; the stage and its options are those of the stage's own file."""

    robot: str = code("firmware_sim.guided_robot:GuidedRobot", "module:Class of the robot's Block")
    robot_options: dict[str, Any] = keywords("keywords it is built with, beside simulator.options", "robot")
    cut: str = code("firmware_sim.toroid_blocks:Toroid", "module:Class of the cut's Block")
    cut_options: dict[str, Any] = keywords("keywords it is built with", "cut")
    pocket: str = code("firmware_sim.milling_blocks:PocketCut", "module:Class of the pocket's Block")
    pocket_options: dict[str, Any] = keywords("keywords it is built with", "pocket")
    tracker: str = code("firmware_sim.tracker_block:TrackerView", "module:Class of the tracker's Block")
    tracker_options: dict[str, Any] = keywords("keywords it is built with", "tracker")
    force_sensor: str = code("firmware_sim.force_sensor_block:ForceSensor", "module:Class of the force sensor's Block")
    force_sensor_options: dict[str, Any] = keywords("keywords it is built with", "force_sensor")
