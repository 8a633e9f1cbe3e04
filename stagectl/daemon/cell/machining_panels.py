"""What is shown of the toroid: the tool's deviation and the stage's travel now, and what each setup came to."""

from collections.abc import Iterator
from typing import Any

from rigkit.experiment.strips import strip
from rigkit.experiment.watch import WINDOW, Watch
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Gauge, Table
from stagectl.daemon.cell.strips import AXES
from stagectl.machining.plan import Plan
from stagectl.machining.report import HEAD, table_rows


def near(watch: Watch, made: Plan) -> Iterator[Gauge]:
    """Give how far the tool is off its path in the workpiece, and with a stage where that is in its travel."""
    deviation, travel = watch.newest("deviation"), watch.newest("travel")
    if deviation is not None:
        for axis, value in zip(AXES, deviation.tolist(), strict=True):
            yield Gauge(f"deviation_{axis}", f"Tool off its path, {axis}", value, "m")
    if travel is not None:
        for axis, value in zip(AXES, travel.tolist(), strict=True):
            yield Gauge(f"travel_{axis}", f"Stage, travel {axis}", value, "m", *made.stage.limits.travel)


class MachiningPanels:
    """Draws setups on a desk.

    Parameters
    ----------
    desk : Desk
    watch : Watch
    """

    def __init__(self, desk: Desk, watch: Watch) -> None:
        self._desk, self._watch = desk, watch
        self._rows: list[dict[str, Any]] = []

    def draw(self) -> None:
        """Draw the last seconds."""
        for name, title in (("deviation", "Tool off its path"), ("travel", "Stage, asked of it")):
            time, rows = self._watch.lately(name)
            if len(time):
                self._desk.show(name, strip(f"{title}, last {WINDOW:g} s", Axis(title, "m"), time, rows, AXES))

    def keep(self, row: dict[str, Any]) -> None:
        """Take the figures of a setup into the table."""
        self._rows.append(row)
        self._desk.show("accuracy", Table("The toroid in steel, lengths in µm", HEAD, tuple(table_rows(self._rows))))
