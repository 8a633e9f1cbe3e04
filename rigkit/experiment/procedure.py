"""The daemon's side of an experiment: a procedure that runs it, says what it does, and draws the last seconds."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from rigkit.experiment.kept import ended_early, run
from rigkit.experiment.kind import Experiment, Kind
from rigkit.experiment.part import nothing
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.experiment.strips import PERIOD, strip
from rigkit.experiment.watch import WINDOW, Watch
from rigkit.run_folder import RunFolder
from rigkit.service.regularly import Regularly
from rigkit.service.rig import Desk
from rigkit.service.show import Axis, Gauge, Panel
from rigkit.stop import Stopped

_OWN = ("started", "held", "ended")
"""Events of a part, in the run's folder, that the desk hears of in other words."""


@dataclass(frozen=True)
class Strip:
    """A panel of the last seconds.

    Parameters
    ----------
    name, unit : str
        Of the panel and its axis.
    signals : sequence of str
        Names of what is seen.
    lines : sequence of str
        Of the columns of all of them.
    title : str
        The name, unless given.
    valid : str
        Name of what is 0 where nothing is to be drawn, if there is such.
    """

    name: str
    unit: str
    signals: Sequence[str]
    lines: Sequence[str]
    title: str = ""
    valid: str = ""


class View(Protocol):
    """What is seen of an experiment while it runs."""

    @property
    def sources(self) -> Mapping[str, str]:
        """Outputs "block.port" by the names under which they are asked for."""

    def lately(self, watch: Watch) -> Iterable[tuple[str, Panel]]:
        """Give panels of the last seconds, by name: as of `strips_of`, or others."""

    def gauges(self, watch: Watch) -> Iterable[Gauge]:
        """Give what is measured now, of which one at least is the output."""

    def after(self, part: str, path: Path) -> Mapping[str, Panel]:
        """Return panels on a part that has ended, by name, from what is recorded of it in a folder."""


class ExperimentProcedure:
    """One run of an experiment under the daemon.

    Parameters
    ----------
    kind : Kind
    title : str
        What it does, for the progress.
    folder : RunFolder
        Of a new run, or of one that is gone on with.
    experiment : Experiment
    view : View
    desk : Desk
    is_paced : bool
        Whether what is simulated keeps to the clock on the wall.
    halt : callable()
        Called at a STOP, from any thread: does at once what needs no look.
    finishes : bool
        Whether an abort lets a part that is under way come to its end.
    """

    def __init__(
        self,
        kind: Kind,
        title: str,
        folder: RunFolder,
        experiment: Experiment,
        view: View,
        desk: Desk,
        *,
        is_paced: bool,
        halt: Callable[[], object] = nothing,
        finishes: bool = False,
    ) -> None:
        self._kind, self._title, self._experiment = kind, title, experiment
        self._view, self._desk, self._halt, self._finishes = view, desk, halt, finishes
        self._watch, self._is_stopped, self._part = Watch(view.sources, is_paced), False, ""
        desk.progress(0.0, experiment.seconds, "getting ready")
        self._folder = folder
        folder.listener = self._heard

    def stop(self) -> None:
        """End it at its next look: from any thread."""
        self._is_stopped = True
        self._halt()

    def gauges(self) -> list[Gauge]:
        """Return what is measured now."""
        return list(self._view.gauges(self._watch))

    def run(self) -> None:
        """Run it and write the report.

        Raises
        ------
        Stopped : the desk said that it is to end.
        Whatever ends a part.
        """
        desk, watch = self._desk, self._watch
        stopped = self._stopped if self._finishes else self._ending
        conduct = Conduct(
            stopped, watch, watch.look, self._show, self._between, self._after, goes_on=False, held=desk.held
        )
        with self._folder as folder:
            desk.recording(True)
            try:
                with Regularly(self._draw, PERIOD):
                    reasons, found = run(folder, self._kind, self._experiment, conduct)
            finally:
                desk.recording(False)
                watch.forget()
            if STOPPED in reasons.values():
                raise Stopped("ended on request; the recording is stored")
            for part, reason in reasons.items():
                raise ValueError(ended_early(part, reason))
            told = {name: value for name, value in found.items() if isinstance(value, int | float | str)}
            desk.event("finished", {"run": folder.path.name, **told})

    def _stopped(self) -> bool:
        return self._is_stopped

    def _ending(self) -> bool:
        return self._is_stopped or self._desk.ending()

    def _show(self, seconds: float) -> None:
        what = f"{self._title}, {self._part}" if self._part else self._title
        self._desk.progress(seconds, self._experiment.seconds, what)

    def _between(self, part: str) -> None:
        """Wait here while it is held."""
        self._part = part
        if self._desk.held() and not self._ending():
            self._desk.event("held", {"before": part})
            self._desk.wait_while_held()
        if self._ending():
            raise Stopped("ended on request; the recording is stored")

    def _after(self, part: str) -> None:
        self._draw()
        self._watch.forget()
        for name, panel in self._view.after(part, self._folder.path).items():
            self._desk.show(name, panel)

    def _heard(self, event: str, fields: Mapping[str, Any]) -> None:
        if event not in _OWN or "part" not in fields:
            self._desk.event(event, fields)

    def _draw(self) -> None:
        for name, panel in self._view.lately(self._watch):
            self._desk.show(name, panel)


def strips_of(watch: Watch, strips: Iterable[Strip]) -> Iterator[tuple[str, Panel]]:
    """Draw strips of what has been seen, by their names.

    Parameters
    ----------
    watch : Watch
    strips : iterable of Strip
    """
    for each in strips:
        found = [watch.lately(signal) for signal in each.signals]
        count = min(len(time) for time, _ in found)
        if count:
            rows = np.column_stack([rows[-count:] for _, rows in found])
            if each.valid and len(valid := watch.lately(each.valid)[1]) >= count:
                rows = np.where(valid[-count:] > 0.5, rows, np.nan)
            title, what = each.title or each.name.capitalize(), Axis(each.title or each.name, each.unit)
            time = found[0][0][-count:]
            yield each.name, strip(f"{title}, last {WINDOW:g} s", what, time, rows, tuple(each.lines))
