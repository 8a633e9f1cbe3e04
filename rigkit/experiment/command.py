"""The command line's side of an experiment: run with progress and Ctrl-C, in a folder or in memory, and told."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from rigkit.command import words
from rigkit.experiment.kept import create, in_memory, run
from rigkit.experiment.kind import Experiment, Kind
from rigkit.experiment.runner import Conduct
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable

PAGE = "report.html"


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
    """

    title: str
    is_live: bool
    out: Path | None
    png: Path | None
    json: str | None

    def carry_out(self, kind: Kind, config: BaseModel, experiment: Experiment) -> tuple[str, dict[str, Any]]:
        """Run an experiment; return why it ended before its end, or nothing, and its figures.

        Parameters
        ----------
        kind : Kind
        config : Section
            The whole rig file.
        experiment : Experiment

        Raises
        ------
        Stopped : before there was anything to judge.
        Whatever ends a part; of one that goes into a folder, what was recorded until then is kept.
        """
        with self._watched(experiment) as conduct:
            if self.out is None:
                return in_memory(experiment, conduct)
            with create(self.out, kind, config, experiment) as folder:
                return run(folder, kind, experiment, conduct, self.png)

    def end(self, reason: str) -> None:
        """Say where the report is; raise `Stopped` where the run was."""
        if self.out is not None:
            print(f"report: {self.out / PAGE}", file=words(self.json))  # noqa: T201
        if reason:
            kept = "" if self.out is None else f"; what is recorded is in {self.out}/"
            raise Stopped(f"{reason}: these are the figures of what was run until then{kept}")

    @contextmanager
    def _watched(self, experiment: Experiment) -> Iterator[Conduct]:
        seconds = experiment.seconds
        with stoppable() as stop:
            if self.is_live:
                sys.stderr.write(f"{self.title}: {seconds:g} s in real time\n")
                yield Conduct(lambda: stop.made)
                return
            with progress(self.title, seconds) as meter:
                yield Conduct(lambda: stop.made, show=meter.show)
