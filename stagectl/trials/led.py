"""How a run is conducted whose robot is led over its wires."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from stagectl.robot.live.clock import ReportClock
from stagectl.robot.live.wires import LiveWires
from stagectl.trials.conduct import Conduct


def led(conduct: Conduct, wires: LiveWires, every: int) -> Conduct:
    """Return a conduct whose clock is the robot's report, and which holds the robot once the graph ticks no more.

    Parameters
    ----------
    conduct : Conduct
    wires : LiveWires
    every : int
        Ticks a report.
    """

    def tell(event: str, fields: Mapping[str, Any]) -> None:
        if event != "robot_fault" or not wires.port.reason:  # the wire's port has said why; the graph's says it again
            conduct.tell(event, fields)

    return replace(conduct, tell=tell, advance=ReportClock(wires, every), rest=wires.port.stop)
