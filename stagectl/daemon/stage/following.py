"""The procedure that follows: a run of the stage behind its link, or of the simulated one, paced."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from rigkit.experiment.pace import Pace
from rigkit.faults import FaultTable
from rigkit.provenance import software
from rigkit.run_folder import RunFolder
from rigkit.service.paths import run_path
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Gauge
from rigkit.stream_recorder import StreamRecorder
from stagectl.config import StageConfig
from stagectl.daemon.gauges import driven, motion, paced
from stagectl.daemon.options import FollowOptions, HoldOptions
from stagectl.daemon.stage.monitor import Monitor, tracked
from stagectl.daemon.stage.panels import PERIOD, Panels
from stagectl.daemon.stage.ready import Ready
from stagectl.daemon.stage.spoiled import spoiled
from stagectl.experiments.piezo import live, session
from stagectl.experiments.piezo.cell import RECORDED, Cell, simulated
from stagectl.experiments.piezo.held_reference import HeldReference
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.report import run_report
from stagectl.experiments.piezo.run_setup import RESUMED
from stagectl.experiments.piezo.streamed import RECORDING, convert, recorder

_LONG = ("started", "recorded")
"""Events of a run folder that the daemon tells by itself, or that are for the report."""


class Following:
    """One run under the daemon.

    Parameters
    ----------
    ready : Ready
    config : StageConfig
        Settings of this run.
    options : FollowOptions or HoldOptions
    desk : Desk
    faults : FaultTable or None

    Raises
    ------
    ValueError, OSError : there is no such loop, the reference is none, or there is no room; no folder is made.
    """

    def __init__(
        self,
        ready: Ready,
        config: StageConfig,
        options: FollowOptions | HoldOptions,
        desk: Desk,
        faults: FaultTable | None,
    ) -> None:
        self._ready, self._desk, self._faults = ready, desk, faults
        desk.progress(0.0, config.session.seconds, "designing the loops")
        self._made = ready.setup(config, options.accept)
        for text in self._made.said:
            desk.event("note", {"text": text})
        path = run_path(config.daemon.data, options.run)
        self._folder = session.make_folder(path, self._made, ready.models, options.accept)
        self._folder.listener = self._heard
        self.monitor = Monitor(self._made)
        self.pace = Pace(self._made.timeline.rate)
        self._stopped = self._is_held = False

    def stop(self) -> None:
        """Take the stage to rest: within ten milliseconds, from any thread."""
        self._stopped = True
        if self._ready.link is not None:
            self._ready.link.halt()

    def gauges(self) -> Iterator[Gauge]:
        """Give how well it follows; of a simulated stage, where that is, what drives it, and how late it is."""
        config, monitor = self._made.config, self.monitor
        if config.session.live:
            yield from tracked(config, monitor)
            return
        yield from motion(config, monitor.position, monitor.voltage)
        yield from tracked(config, monitor)
        yield from driven(config, monitor.voltage)
        yield from paced(self.pace)

    def run(self) -> None:
        """Follow to the end, and write the report; or until it is to end."""
        with self._folder as folder:
            if self._is_ending():
                folder.withdraw()
                return
            with Regularly(Panels(self._desk, self._made, self.monitor).draw, PERIOD):
                kept = self._followed(folder)
            figures = live.finish(folder, replace(self._made, held=self.monitor.held), kept)
            ended = "left" if self._is_ending() else "finished"
            self._desk.event(ended, {"run": folder.path.name, **figures})
            if ended == "finished":  # else nobody waits for it: `stagectl report` draws it at any time
                total = self._made.timeline.total / self._made.timeline.rate
                self._desk.progress(total, total, "writing the report")
                run_report(folder.path)

    def _is_ending(self) -> bool:
        return self._stopped or self._desk.ending()

    def _followed(self, folder: RunFolder) -> StreamRecorder:
        self._ready.tell = self._tell
        self._desk.recording(True)
        try:
            if self._ready.link is None:
                return self._simulated(folder)
            watching = {"monitor": self.monitor}
            return live.follow(self._ready.link, folder, self._made, self._is_ending, watching, self._hold)
        finally:
            self._desk.recording(False)

    def _simulated(self, folder: RunFolder) -> StreamRecorder:
        made, config = self._made, self._made.config
        kept = recorder(folder, config, RECORDED)
        seen = simulated(config)
        if self._faults is not None:
            seen = spoiled(seen, self._faults, config)
        wanted = wanted_position(config, made.timeline)
        cell = Cell(made, wanted, seen, config.deflection.on, {"record": kept, "monitor": self.monitor})
        folder.event("started", {"software": software(), **session.designed(made)})
        with kept:
            fault = cell.run(self.pace.until, self._is_ending, self._hold)
        convert(folder, config, kept)
        session.tell_recorded(folder, RECORDING, cell, kept.recorded)
        if fault is not None:
            raise ValueError(fault)
        return kept

    def _hold(self, reference: HeldReference, ticks: int) -> None:
        """Hold the reference as the desk says; tell when it has come to a stop, and when it has its pace again."""
        reference.hold(self._desk.held() and not self._is_ending())
        self.monitor.held = reference.held
        if reference.is_held and not self._is_held:
            self._folder.event("held", {"sample": ticks})
        elif reference.is_playing and self._is_held:
            self._folder.event(RESUMED, {"sample": ticks, "samples": reference.held})
        self._is_held = reference.is_held or (self._is_held and not reference.is_playing)

    def _heard(self, event: str, fields: Mapping[str, Any]) -> None:
        if event not in _LONG:
            self._desk.event(event, fields)

    def _tell(self, event: str, fields: Mapping[str, Any]) -> None:
        self._folder.event(event, fields)
