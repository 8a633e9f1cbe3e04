"""What the figures of a report are drawn from: a run's recordings, and the setup it was made with."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from rigkit.figure_style import LIMIT
from stagectl.experiments.piezo.cell import RECORDING, UNCOMPENSATED
from stagectl.experiments.piezo.figures import error_of, proper, wanted_name
from stagectl.experiments.piezo.setup import Setup

BOUND: dict[str, Any] = {**LIMIT}
"""Keywords of a line that shows a limit."""


@dataclass(frozen=True)
class Result:
    """A run, read back.

    Parameters
    ----------
    made : Setup
    record : Recording
    before : Recording or None
        The run without compensation.
    """

    made: Setup
    record: Recording
    before: Recording | None

    @property
    def axes(self) -> tuple[str, ...]:
        """The names of the axes."""
        return self.made.config.stage.axes

    def proper(self, name: str) -> np.ndarray:
        """Return a signal over the run proper, shape (samples, axes), m or V."""
        return self.record.select([f"{name}_{axis}" for axis in self.axes]).data[self.made.timeline.proper]

    @property
    def time(self) -> np.ndarray:
        """The time of the run proper, shape (samples,), s."""
        return np.arange(len(self.proper("position"))) / self.record.rate

    @property
    def error(self) -> np.ndarray:
        """The error that is shown, shape (samples, axes), m: of the tool where deflection is compensated."""
        pair = (wanted_name(self.made), "absolute") if self.made.config.deflection.on else ("reference", "position")
        return error_of(self.record, self.made, *pair)

    @property
    def error_before(self) -> np.ndarray | None:
        """The tool's error without compensation, shape (samples, axes), m, or None."""
        return None if self.before is None else error_of(self.before, self.made, wanted_name(self.made), "absolute")


def result_of(records: Mapping[str, Recording], made: Setup) -> Result:
    """Return a run from its recordings; ValueError if nothing of the run proper is recorded."""
    record = proper(records, RECORDING, made)
    if record is None:
        raise ValueError("nothing of the run proper is recorded")
    return Result(made, record, records.get(UNCOMPENSATED))
