"""How a run is conducted whose robot is led over its wires."""

from dataclasses import replace

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
    return replace(
        conduct, tell=wires.unless_told(conduct.tell), advance=ReportClock(wires, every), rest=wires.port.stop
    )
