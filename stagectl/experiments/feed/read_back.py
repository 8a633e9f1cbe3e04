"""Runs of force-controlled milling in their folder: what they are made from, kept there and read back."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from calibration.state_space.model import InnovationModel
from rigkit import config as rig_file
from rigkit.experiment.kept import told
from rigkit.experiment.kind import Experiment, Kind, Records
from rigkit.experiment.runner import KILLED
from rigkit.json_file import read_json
from rigkit.run_folder import CONFIG, RunFolder, read_events
from stagectl.experiments.feed.bench import Bench
from stagectl.experiments.feed.job import Job, read_job
from stagectl.experiments.feed.pockets import Pockets, Told
from stagectl.experiments.feed.process import FedProcess
from stagectl.models.model_file import read_model
from stagectl.models.model_origin import refuse_other_wiring
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.wire.robot import RATE

JOB, MODEL, FEEDS = "job.json", "velocity.h5", "feeds.json"
"""Files of a run's folder; the last one in those of version 0.1.0 only."""


@dataclass(frozen=True)
class Files:
    """What is milled, and the velocity model's file, where there is one.

    Parameters
    ----------
    job : Job
    model : Path or None
    """

    job: Job
    model: Path | None

    @property
    def velocity(self) -> InnovationModel:
        """The robot's velocity model: that of the file, or the nominal one."""
        return velocity_model(self.model)

    def refuse_foreign(self, cell: CellConfig, accept: Collection[str]) -> list[str]:
        """Refuse a model of a cell that was wired otherwise, by DisagreementError; return what is to be said.

        Parameters
        ----------
        cell : CellConfig
        accept : collection of str
            Keys that may differ.
        """
        provenance = self.velocity.provenance
        return [] if self.model is None else refuse_other_wiring(cell, self.model, provenance, accept, "cell")

    def take_into(self, folder: RunFolder) -> list[str]:
        """Copy them into the folder of a run; return their names there."""
        folder.write(JOB, self.job.text())
        if self.model is None:
            return [JOB]
        folder.take_in(self.model, MODEL)
        return [JOB, MODEL]

    def experiment(
        self, cell: CellConfig, bench: Bench | None = None, told: Mapping[str, Told] | None = None
    ) -> Experiment:
        """Return the run."""
        if self.job.pocket is None:
            return FedProcess(cell, self.velocity)
        return Pockets(cell, self.job, self.velocity, bench, told)


def velocity_model(file: Path | None) -> InnovationModel:
    """Return the robot's velocity model: that of a file, or the nominal one."""
    return nominal_velocity(RATE) if file is None else read_model(file, rate=RATE)


def is_of_feed(path: Path) -> bool:
    """Whether a folder is one of a run of `stagectl force`."""
    return (path / CONFIG).is_file() and (path / JOB).is_file()


def read_back(path: Path, records: Records, settings: Sequence[str] = ()) -> Experiment:  # noqa: ARG001 (a reader's)
    """Return the run of a folder, for report and replay.

    Parameters
    ----------
    path : Path
    records : mapping of str to Recording
    settings : sequence of str
        None: another feed would have been another cut.

    Raises
    ------
    ValueError : it is no folder of theirs.
    """
    if not is_of_feed(path):
        raise ValueError(f"{path}/ is not the folder of a run of force control: it has no {CONFIG} and {JOB}")
    cell, job = rig_file.load(path / CONFIG, CellConfig), read_job(path / JOB)
    files = Files(job, path / MODEL if (path / MODEL).exists() else None)
    return files.experiment(cell, told=_told(path))


def _told(path: Path) -> dict[str, Told]:
    """Return what is told of each pocket."""
    found = {part: Told(KILLED) for part in told(path, "started")}
    found |= {part: Told(end["reason"]) for part, end in told(path, "ended").items()}
    for event in read_events(path):
        if event["event"] == "milled":  # version 0.1.0
            feeds = read_json(path / FEEDS, dict) if event["name"].startswith("position") else None
            found[event["name"]] = Told(event["reason"], event["path"], feeds)
    return found


FORCE = Kind("force run", read_back, apart=("learning.model",), what_if=False, is_older=is_of_feed)
