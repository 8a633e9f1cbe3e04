"""The command line's side of an experiment: run with progress and Ctrl-C, in a folder or in memory, and told."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import BaseModel

from ctlblocks.clock import Clock, Offline
from rigkit.command import words
from rigkit.experiment.kept import create, in_memory, run
from rigkit.experiment.kind import Experiment, Kind
from rigkit.experiment.resumed import GoingOn, Some, take_up
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable

PAGE = "report.html"
RunOption = Annotated[
    Path | None, typer.Option("--out", metavar="RUN/", help="Folder to make for recording and report.")
]


def refuse_given(given: Mapping[str, object]) -> None:
    """Refuse options beside `--resume` that would be those of a new run, by ValueError; None is not given."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"{name} and --resume are given, must be one of them: a run has its own settings")


def refuse_png_alone(png: Path | None, out: Path | None) -> None:
    """Refuse pictures without a run's folder that they are of, by ValueError."""
    if png is not None and out is None:
        raise ValueError("--png goes with --out RUN/, which is not given")


@dataclass(frozen=True)
class CommandLine:
    """What a person wants of a run.

    Parameters
    ----------
    title : str
        What is being done, for the progress.
    is_live : bool
        Whether something is led in real time: then nothing is printed meanwhile.
    out, png : Path or None
        Folder of the run, and of its figures as PNG files.
    json : str or None
        Where its figures go as JSON.
    clock : Clock
        Of what is simulated.
    unit : str
        In which the experiment tells its length.
    """

    title: str
    is_live: bool
    out: Path | None
    png: Path | None
    json: str | None
    clock: Clock = field(default_factory=Offline)
    unit: str = "s"

    def carry_out(
        self, kind: Kind, config: BaseModel, experiment: Experiment, **folder: Any
    ) -> tuple[dict[str, str], dict[str, Any]]:
        """Run an experiment; return why parts ended before their end, by name, and its figures.

        Parameters
        ----------
        kind : Kind
        config : Section
            The whole rig file.
        experiment : Experiment
        **folder
            As of `kept.create`.

        Raises
        ------
        Stopped : before there was anything to judge.
        Whatever ends a part; of one that goes into a folder, what was recorded until then is kept.
        """
        with self._watched(experiment) as conduct:
            if self.out is None:
                return in_memory(experiment, conduct)
            with create(self.out, kind, config, experiment, **folder) as made:
                return run(made, kind, experiment, conduct, self.png)

    def go_on(self, kind: Kind, way: GoingOn[Some]) -> tuple[dict[str, str], dict[str, Any]]:
        """Run what is left of a run in the folder `out`; return as `carry_out` does, the figures of all of it.

        Parameters
        ----------
        kind : Kind
        way : GoingOn

        Raises
        ------
        As `kept.take_up`, and as `carry_out`.
        """
        assert self.out is not None  # a run without a folder leaves nothing to go on with
        folder, experiment = take_up(self.out, way)
        with folder, self._watched(experiment) as conduct:
            return run(folder, kind, experiment, conduct, self.png)

    def end(self, reasons: Mapping[str, str]) -> None:
        """Say where the report is, if there is one; raise `Stopped` where the run was."""
        if self.out is not None and (self.out / PAGE).exists():
            print(f"report: {self.out / PAGE}", file=words(self.json))  # noqa: T201
        if STOPPED in reasons.values():
            kept = "" if self.out is None else f"; what is recorded is in {self.out}/"
            raise Stopped(f"{STOPPED}: these are the figures of what was run until then{kept}")

    @contextmanager
    def _watched(self, experiment: Experiment) -> Iterator[Conduct]:
        seconds = experiment.seconds
        with stoppable() as stop:
            if self.is_live:
                sys.stderr.write(f"{self.title}: {seconds:g} {self.unit} in real time\n")
                yield Conduct(lambda: stop.made, self.clock)
                return
            with progress(self.title, seconds) as meter:
                yield Conduct(lambda: stop.made, self.clock, show=meter.show)
