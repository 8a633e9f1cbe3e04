"""What is recorded of the cell: which signals, at which rates, under which names."""

from dataclasses import dataclass

from ctlblocks import Port
from ctlblocks.recording import Recording
from ctlblocks.replay import Record
from stagectl.machining.plan import AXES, Plan

SLOW, QUICK = 40, 5
"""Ticks between two samples of the robot port and mid-ranging, and of robot and tracker."""


@dataclass(frozen=True)
class Signal:
    """One signal.

    Parameters
    ----------
    name : str
    source : str
        "block.port", or a word that `surroundings` have an output for.
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
        """The names of its channels: axes of three, numbers of more or less."""
        if self.width == 1:
            return (self.name,)
        return tuple(f"{self.name}_{each}" for each in (AXES if self.width == 3 else range(1, self.width + 1)))


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
MADE = {
    "cell": (
        Signal("deviation", "relative.deviation"),
        Signal("fast_reference", "midranging.fast_reference"),
        Signal("slow_reference", "midranging.slow_reference"),
        Signal("correction", "correction.correction", "rad", 6),
        Signal("reference", "port.reference", "rad", 6),
        Signal("holding", "port.holding", "1", 1),
    ),
    "stage": (
        Signal("reference", "travel.reference"),
        Signal("extension_reference", "controller.extension_reference"),
        Signal("voltage", "guard.voltage", "V"),
    ),
}
"""What the controllers make of it, by recording."""
SURFACE = (Signal("cut", "cut"), Signal("wanted", "wanted.position"), Signal("force", "force", "N"))
NOMINAL = (Signal("nominal", "path.nominal", "rad", 6),)
EVERY = {"cell": SLOW, "surface": QUICK, "tracker": QUICK, "stage": 1}
"""Ticks between two samples, by recording."""


def recordings(plan: Plan) -> dict[str, tuple[Signal, ...]]:
    """Return the signals of each recording of a setup."""
    found = {"cell": (*NOMINAL, *ROBOT, *MADE["cell"]), "surface": SURFACE, "tracker": TRACKER}
    if plan.has_stage:
        found |= {"tracker": (*TRACKER, *LASER), "stage": (*PLATE, *MADE["stage"])}
    return found


def named(record: Record, signals: tuple[Signal, ...], provenance: dict[str, str]) -> Recording:
    """Return what was recorded, its channels under the names of their axes and joints.

    Parameters
    ----------
    record : Record
    signals : tuple of Signal
    provenance : dict of str to str
    """
    kept = record.recording(provenance)
    names = tuple(name for signal in signals for name in signal.channels)
    return Recording(names, kept.units, kept.rate, kept.data, kept.provenance)
