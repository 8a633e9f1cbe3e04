"""Runs of the simulation of fig. 7.5 in their folder: recorded, measured, drawn, and made again."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from calibration.state_space.model import InnovationModel
from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.experiment.replayed import Replayed, compared
from rigkit.figure_style import styled
from rigkit.report import Fact, Report, Section, Table
from rigkit.run_folder import CONFIG, RunFolder
from stagectl.feed.figures import PROCESS, control_plot
from stagectl.feed.process_run import process_figures, recorded, run_process, simulated
from stagectl.feed.session import MODEL, velocity_model
from stagectl.robot.config import CellConfig

RECORD, PAGE = "process.csv", "report.html"


def simulate(cell: CellConfig, model: InnovationModel) -> Recording:
    """Run the simulation that the cell's file describes."""
    plants = cell.feed_plants
    return run_process(cell.force, model, simulated(plants.process, plants.process_options))


def keep(folder: RunFolder, record: Recording, cell: CellConfig) -> dict[str, Any]:
    """Write recording and figures into a run's folder, and return these."""
    recording.write(folder.path / RECORD, record)
    found = process_figures(record, cell.force.force)
    folder.summarise(found)
    return found


def process_report(path: Path, png: Path | None = None) -> dict[str, Any]:
    """Write `report.html` into a run's folder; return the run's figures.

    Parameters
    ----------
    path : Path
    png : Path, optional
        Folder for the figures as PNG files as well.
    """
    cell, record = _read_back(path)
    found = process_figures(record, cell.force.force)
    with styled():
        plot = control_plot(record, cell.force.force, PROCESS)
        facts = (Fact("Largest force before control", f"{found['force_before']:.1f} N"),)
        table = Table(("figure", "value"), tuple(process_rows(found)))
        sections = (Section("Control", plots=(plot,), tables=(table,)),)
        report = Report("Force control as in fig. 7.5", str(path.resolve()), facts, sections)
        report.write(path / PAGE)
        if png is not None:
            report.png(png)
    return found


def process_rows(found: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the figures as text."""
    for key, words, scale, unit in (
        ("activation", "control begins after", 1.0, "s"),
        ("force_before", "largest force until then", 1.0, "N"),
        ("settled_after", "settled to 5 % after", 1.0, "s"),
        ("mean_error", "mean error", 1.0, "N"),
        ("largest_error", "largest error", 1.0, "N"),
        ("kappa_error", "kappa, rms error", 1e3, "mm/(N s)"),
        ("beta_error", "beta, rms error", 1.0, ""),
    ):
        yield words, "never" if found[key] is None else f"{scale * found[key]:.4g} {unit}".rstrip()


def replay_process(path: Path) -> Iterator[Replayed]:
    """Make every output of a folder's run again from what was seen of the process."""
    cell, record = _read_back(path)
    model = velocity_model(path / MODEL if (path / MODEL).exists() else None)
    seconds = len(record.data) / record.rate
    again = run_process(cell.force, model, recorded(record), seconds, is_true=False)
    yield from compared("process", record, again)


def _read_back(path: Path) -> tuple[CellConfig, Recording]:
    if not (path / RECORD).exists():
        raise ValueError(f"{path}: nothing is recorded")
    return rig_file.load(path / CONFIG, CellConfig), recording.read(path / RECORD)
