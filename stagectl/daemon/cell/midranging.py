"""The procedure of mid-ranging: the macro and the micro manipulator share one position."""

from collections.abc import Iterable

import numpy as np

from ctlblocks import Graph
from rigkit.service.paths import data_file, run_path
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Gauge
from rigkit.stop import Stopped
from stagectl.daemon.cell.conductor import Conductor
from stagectl.daemon.cell.midranging_gauges import LIVE, SIMULATED, of_a_live_pair, of_a_simulation
from stagectl.daemon.cell.options import MidrangeOptions
from stagectl.daemon.cell.strips import PERIOD, strip
from stagectl.daemon.cell.watch import WINDOW
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging import session
from stagectl.robot.midranging.axes import Runs, run_axes
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging.live_pair import LivePair
from stagectl.robot.midranging.scenario import SCENARIOS, scenarios

SEEN = {"reference": "wanted.reference"}


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
        self._is_live = config.midranging.session.live
        options.refuse_live("midranging.session.live", self._is_live)
        sources = SEEN | (LIVE if self._is_live else SIMULATED)
        self._conductor, self._desk, self._cell = Conductor(desk, sources, options.paced), desk, config
        self._pair: LivePair | None = None
        self._name, name = options.controller, options.scenario
        file = name if name in SCENARIOS else str(data_file(config.daemon.data, "scenario", name, SCENARIOS))
        self._chosen = scenarios(file, config.midranging.pair.rate)
        made = controller(self._name, config.midranging, len(self._chosen))
        self._kept = session.about(self._name, name)
        self._axes = [axis or config.midranging.session.axis for axis in self._chosen] if self._is_live else [""]
        lead, rate = config.midranging.session.lead, config.midranging.pair.rate
        lengths = [lead + len(each.reference) / rate for each in self._chosen.values()]
        self._done, self._total = 0.0, max(lengths) if self._is_live else sum(lengths)
        desk.progress(0.0, self._total, "getting ready")
        path = run_path(config.daemon.data, options.run)
        session.require_room(path, made, self._chosen)
        self._folder = session.create(path, config)

    def stop(self) -> None:
        """End it; live, the robot is held and the stage goes to mid-travel."""
        self._conductor.stop()

    def gauges(self) -> Iterable[Gauge]:
        """Give the control signal and the micro manipulator's position; live, what is asked of robot and stage."""
        watch, pair = self._conductor.watch, self._pair
        if not self._is_live:
            return of_a_simulation(watch, self._cell.midranging)
        return () if pair is None else of_a_live_pair(watch, self._cell, self._axes, pair)

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
                self._pair = None
                conductor.watch.forget()
            if conductor.ending():
                session.write(folder, runs, self._kept)
                raise Stopped("ended, as asked; what is recorded is kept")
            desk.progress(self._total, self._total, "writing the report")
            found = session.keep(folder, runs, self._chosen, self._cell, self._kept)
            desk.event("finished", {"run": folder.path.name, "iae": found["iae"], "fast_peak": found["fast_peak"]})

    def _ran(self) -> Runs:
        return run_axes(self._name, self._cell, self._chosen, self._conductor.ending, self._advance, self._look)

    def _advance(self, graph: Graph, ticks: int) -> None:
        self._conductor.watch.advance(graph, ticks)
        self._done += ticks / graph.rate
        self._desk.progress(self._done, self._total, f"{self._name}, {self._kept['scenario']}")

    def _look(self, graph: Graph, pair: LivePair) -> None:
        """See what a tick over the wires has done."""
        self._pair = pair
        if graph.ticks:
            self._conductor.watch.look(graph)
            self._desk.progress(graph.ticks / graph.rate, self._total, f"{self._name}, {self._kept['scenario']}")

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
                lines = tuple(f"{part} {axis}".strip() for part in parts for axis in self._axes)
                rows = np.column_stack([rows[-count:] for _, rows in found])
                title = f"{name.capitalize()}, last {WINDOW:g} s"
                self._desk.show(name, strip(title, Axis(name, unit), found[0][0][-count:], rows, lines))
