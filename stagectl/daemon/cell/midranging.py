"""The procedure of mid-ranging: the macro and the micro manipulator share one position."""

import numpy as np

from ctlblocks import Graph
from rigkit import config as rig_file
from rigkit.run_folder import RunFolder
from rigkit.service.paths import data_file, run_path
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Gauge
from rigkit.stop import Stopped
from stagectl.daemon.cell.conductor import Conductor
from stagectl.daemon.cell.gauges import timed
from stagectl.daemon.cell.options import MidrangeOptions
from stagectl.daemon.cell.strips import PERIOD, strip
from stagectl.daemon.cell.watch import WINDOW
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging import session
from stagectl.robot.midranging.axes import Runs, run_axes
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging.scenario import SCENARIOS, scenarios

SOURCES = {
    "reference": "wanted.reference", "position": "pair.position", "fast": "pair.fast", "slow": "pair.slow",
    "control": "pair.control",
}  # fmt: skip


class Midranging:
    """One run of one controller under the daemon.

    Parameters
    ----------
    config : CellConfig
    options : MidrangeOptions
    desk : Desk

    Raises
    ------
    ValueError, OSError : a live one is to be paced, there is no such scenario, or settings do not fit together; no
        folder is made.
    """

    def __init__(self, config: CellConfig, options: MidrangeOptions, desk: Desk) -> None:
        options.refuse_live("midranging.session.live", config.midranging.session.live)
        self._conductor, self._desk, self._cell = Conductor(desk, SOURCES, options.paced), desk, config
        self._name, name = options.controller, options.scenario
        file = name if name in SCENARIOS else str(data_file(config.daemon.data, "scenario", name, SCENARIOS))
        self._chosen = scenarios(file, config.midranging.pair.rate)
        made = controller(self._name, config.midranging, len(self._chosen))
        self._kept = session.about(self._name, name)
        lead, rate = config.midranging.session.lead, config.midranging.pair.rate
        self._done, self._total = 0.0, sum(lead + len(each.reference) / rate for each in self._chosen.values())
        desk.progress(0.0, self._total, "getting ready")
        path = run_path(config.daemon.data, options.run)
        session.require_room(path, made, self._chosen)
        self._folder = RunFolder.create(path, rig_file.dump(config))

    def stop(self) -> None:
        """End it; live, the robot is held and the stage goes to mid-travel."""
        self._conductor.stop()

    def gauges(self) -> list[Gauge]:
        """Return the control signal and the micro manipulator's position against their limits."""
        watch, config = self._conductor.watch, self._cell.midranging
        control, fast = watch.newest("control"), watch.newest("fast")
        if control is None or fast is None:
            return list(timed(watch))
        most, low, high = config.inner.limit, -config.pair.travel, config.pair.travel
        place = float(fast[0]) - config.pair.middle
        return [
            Gauge(
                "control", "Control signal of the micro manipulator", float(control[0]), "m/s", -most, most, None, True
            ),
            Gauge("micro", "Micro manipulator, from its middle", place, "m", low, high),
            *timed(watch),
        ]

    def run(self) -> None:
        """Run it and write the report.

        Raises
        ------
        Stopped : the desk said that it is to end.
        LinkError : a live run that a fault has ended.
        """
        conductor, desk = self._conductor, self._desk
        with self._folder as folder:
            desk.recording(True)
            try:
                with Regularly(self._draw, PERIOD):
                    runs = session.recorded(folder, self._ran, self._chosen, self._kept)
            finally:
                desk.recording(False)
                conductor.watch.forget()
            if conductor.ending():
                session.write(folder, runs, self._kept)
                raise Stopped("ended, as asked; what is recorded is kept")
            desk.progress(self._total, self._total, "writing the report")
            found = session.keep(folder, runs, self._chosen, self._cell, self._kept)
            desk.event("finished", {"run": folder.path.name, "iae": found["iae"], "fast_peak": found["fast_peak"]})

    def _ran(self) -> Runs:
        return run_axes(self._name, self._cell, self._chosen, self._conductor.ending, self._advance)

    def _advance(self, graph: Graph, ticks: int) -> None:
        self._conductor.watch.advance(graph, ticks)
        self._done += ticks / graph.rate
        self._desk.progress(self._done, self._total, f"{self._name}, {self._kept['scenario']}")

    def _draw(self) -> None:
        watch = self._conductor.watch
        for name, parts, unit in (
            ("position", ("reference", "position"), "m"),
            ("manipulators", ("slow", "fast"), "m"),
            ("control", ("control",), "m/s"),
        ):
            found = [watch.lately(part) for part in parts]
            count = min(len(time) for time, _ in found)
            if count:
                self._desk.show(name, strip(
                    f"{name.capitalize()}, last {WINDOW:g} s", Axis(name, unit), found[0][0][-count:],
                    np.column_stack([rows[-count:, 0] for _, rows in found]), parts,
                ))  # fmt: skip
