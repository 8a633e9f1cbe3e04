"""The simulation of fig. 7.5 as an experiment: one part, without robot and wood."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from calibration.state_space.model import InnovationModel
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit.experiment.kept import early_facts
from rigkit.experiment.kind import Records
from rigkit.experiment.part import Part
from rigkit.experiment.runner import never
from rigkit.figure_style import styled
from rigkit.named_code import named_block
from rigkit.report import Fact, Report, Section, Table
from stagectl.experiments.feed.figures import PROCESS, control_plot
from stagectl.experiments.feed.process_run import SECONDS, TRACK, process_figures, process_part, recorded, simulated
from stagectl.experiments.feed.report import PAGE
from stagectl.link.tell import Tell, nobody
from stagectl.robot.config import CellConfig
from stagectl.wire.robot import RATE

CHANNELS = 40
"""Of the recording, at most."""


class FedProcess:
    """Force control against a process whose kappa and beta change with time.

    Parameters
    ----------
    cell : CellConfig
    model : InnovationModel
        Of the robot's velocity.

    Raises
    ------
    ValueError : options that the process does not take.
    """

    def __init__(self, cell: CellConfig, model: InnovationModel) -> None:
        self._cell, self._model = cell, model
        named_block(cell.feed_plants.process, dict(cell.feed_plants.process_options))

    seconds = SECONDS
    about: Mapping[str, str] = {"cell": "simulated"}
    designed: Mapping[str, Any] = {"live": False}

    @property
    def room(self) -> int:
        """Bytes that its recording takes."""
        return bytes_of(round(SECONDS * RATE), CHANNELS, "float64", "wav")

    def parts(
        self,
        tell: Tell = nobody,  # noqa: ARG002 (nothing is at fault)
        stopped: Callable[[], bool] = never,  # noqa: ARG002 (nothing is got ready)
    ) -> Iterator[Part]:
        """Give its one part."""
        plants = self._cell.feed_plants
        process = simulated(plants.process, plants.process_options)
        yield process_part(self._cell.force, self._model, process, SECONDS)

    def again(self, records: Records) -> Iterator[Part]:
        """Give its one part with what was seen of the process."""
        for record in records.values():
            seconds = len(record.data) / record.rate
            yield process_part(self._cell.force, self._model, recorded(record), seconds, is_true=False)

    def figures(self, records: Records) -> dict[str, Any]:
        """Return what a run comes to: as of `process_figures`."""
        return process_figures(_record(records), self._cell.force.force)

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report."""
        with styled():
            plot = control_plot(_record(records), self._cell.force.force, PROCESS)
            facts = (Fact("Largest force before control", f"{figures['force_before']:.1f} N"), *early_facts(figures))
            table = Table(("figure", "value"), tuple(process_rows(figures)))
            sections = (Section("Control", plots=(plot,), tables=(table,)),)
            report = Report("Force control as in fig. 7.5", str(path.resolve()), facts, sections)
            report.write(path / PAGE)
            if png is not None:
                report.png(png)


def process_rows(found: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
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


def _record(records: Records) -> Recording:
    if TRACK not in records:
        raise ValueError("nothing is recorded")
    return records[TRACK]
