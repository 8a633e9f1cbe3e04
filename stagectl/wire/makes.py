"""The makes that are known, by the names that a cell's file has for them: a new one is a file and a line here."""

from collections.abc import Callable, Collection

from stagectl.wire.egm import Egm
from stagectl.wire.force_sensor import ForceWire, NetFt
from stagectl.wire.robot import RobotWire
from stagectl.wire.rsi import Rsi
from stagectl.wire.tracker import Packets, TrackerWire

ROBOTS: dict[str, Callable[[], RobotWire]] = {"egm": Egm, "rsi": Rsi}
"""`robot.wire`: ABB's Externally Guided Motion, KUKA's Robot Sensor Interface."""
TRACKERS: dict[str, Callable[[], TrackerWire]] = {"gateway": Packets}
"""`tracker.wire`: the gateway beside an optical tracker."""
FORCE_SENSORS: dict[str, Callable[[], ForceWire]] = {"netft": NetFt}
"""`force_sensor.wire`: ATI's Net F/T, and boxes in its manner."""


def known(name: str, makes: Collection[str]) -> str:
    """Return a make's name; ValueError that says which there are, where it is none."""
    if name not in makes:
        raise ValueError(f"must be one of {', '.join(makes)}")
    return name
