"""What robot, tracker, laser and stage say: the names under which it is seen and recorded."""

from collections.abc import Mapping
from dataclasses import dataclass

from ctlblocks import Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay, numbered

AXES = ("x", "y", "z")
SLOW, QUICK = 40, 5
"""Ticks at 10 kHz between two samples of the robot's port, and of robot and tracker."""

Sources = Mapping[str, tuple[str, bool]]
"""For each word, the output that it stands for, and whether it is read a tick late."""


@dataclass(frozen=True)
class Signal:
    """One signal.

    Parameters
    ----------
    name : str
    source : str
        "block.port", or a word that `Sources` have an output for.
    unit : str
    width : int, channels
    """

    name: str
    source: str
    unit: str = "m"
    width: int = 3

    @property
    def port(self) -> Port:
        """The recorder's port for it."""
        return Port(self.name, self.unit, self.width)

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of its channels."""
        return by_axis(self.port)


ROBOT = (
    Signal("report", "report", "1", 1),
    Signal("motors", "motors", "1", 1),
    Signal("motor_angle", "motor_angle", "rad", 6),
    Signal("planned_angle", "planned_angle", "rad", 6),
)
"""What the robot says."""
TRACKER = (
    Signal("sample", "sample", "1", 1),
    Signal("stamp", "stamp", "s", 1),
    Signal("spindle", "spindle", "1", 7),
    Signal("workpiece", "workpiece", "1", 7),
    Signal("leds", "leds", "1", 2),
    Signal("residual", "residual", "m", 2),
)
"""What the tracker says."""
LASER = (Signal("absolute", "absolute"),)
PLATE = (Signal("position", "position"), Signal("extension", "extension"))
"""What the stage's sensors say."""


def by_axis(port: Port) -> tuple[str, ...]:
    """Return how the channels of a port are called: by the axes of three, by numbers of any other count."""
    return tuple(f"{port.name}_{axis}" for axis in AXES) if port.width == len(AXES) else numbered(port)


def played(record: Recording, signals: tuple[Signal, ...]) -> Replay:
    """Return what plays signals of a recording, a port each."""
    return Replay(record, {signal.name: signal.channels for signal in signals})
