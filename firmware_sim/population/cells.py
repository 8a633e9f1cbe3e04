"""Robot cells drawn by seed: robot, cut, tracker and force sensor; the cut is the family."""

from dataclasses import dataclass
from typing import Any

from firmware_sim.population.cuts import DrawnCut, draw_cut
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.robots import DrawnRobot, draw_robot
from firmware_sim.population.streams import Streams

KIND = "cell"
TRACKER_NOISE, WARP, LOST = (20e-6, 200e-6), (10e-6, 150e-6), (5e-4, 0.02)
"""m rms of an LED, m rms over the volume, and part of the samples."""
FORCE_NOISE, MOMENT, BIAS, DRIFT, CROSSTALK = (0.05, 1.0), 1 / 15, (1.0, 10.0), (0.05, 3.0), (1e-3, 0.03)
"""N rms, m, N rms, N a minute, 1 rms; moments have the noise of forces over a lever of `MOMENT`."""
HOME, SEGMENT_HOME, TOOL = (0.0, 0.349066, 0.174533, 0.0, 1.047198, 0.0), (0.0, 0.0, 0.0, 0.0, 1.5708, 0.0), 0.1
"""rad, rad and m: where a program's default pocket is, where it mills by segments, and from flange to tool."""
TOROID = 50.0, 200.0
"""N, full cut in steel."""


@dataclass(frozen=True)
class DrawnCell:
    """A cell.

    Parameters
    ----------
    robot : DrawnRobot
    cut : DrawnCut
    tracker, sensor : mapping
        Keywords of `TrackerView` and of `ForceSensorOptions`.
    toroid : float, N
        Force of a full cut in steel.
    """

    robot: DrawnRobot
    cut: DrawnCut
    tracker: dict[str, Any]
    sensor: dict[str, Any]
    toroid: float


def draw_cell(seed: int, family: str) -> DrawnCell:
    """Draw a cell; its robot and sensors are those of the seed, whatever the family.

    Parameters
    ----------
    seed : int
    family : str, of `cuts.FAMILIES`
    """
    streams = Streams(seed, KIND)
    robot = draw_robot(streams.within("robot"), seed)
    arm = [robot.mode(home, TOOL) for home in (HOME, SEGMENT_HOME)]
    cut = draw_cut(streams.within(family), seed, family, robot.arm["payload"], arm)
    toroid = float(log_uniform(streams("toroid"), *TOROID))
    return DrawnCell(robot, cut, _tracker(streams, seed), _sensor(streams, seed), toroid)


def _tracker(streams: Streams, seed: int) -> dict[str, Any]:
    rng = streams("tracker")
    names = {"noise": TRACKER_NOISE, "warp": WARP, "lost": LOST}
    return {"seed": seed} | {name: float(log_uniform(rng, *limits)) for name, limits in names.items()}


def _sensor(streams: Streams, seed: int) -> dict[str, Any]:
    rng = streams("force sensor")
    names = {"noise": FORCE_NOISE, "bias": BIAS, "drift": DRIFT, "crosstalk": CROSSTALK}
    found = {"seed": seed} | {name: float(log_uniform(rng, *limits)) for name, limits in names.items()}
    return found | {"moment_noise": MOMENT * found["noise"], "moment_bias": MOMENT * found["bias"]}
