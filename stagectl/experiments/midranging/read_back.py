"""A mid-ranging run read back from its folder."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.experiment.kind import Kind, Records
from rigkit.experiment.part import Part
from rigkit.origin import RUN, read_origin
from rigkit.run_folder import CONFIG
from stagectl.experiments.midranging.experiment import LAW, Midranging
from stagectl.experiments.midranging.scenario import SECONDS, Scenario, scenario
from stagectl.experiments.midranging.schedule import TRACK
from stagectl.robot.config import CellConfig

ADAPTIVE = "aimc"


def read_back(path: Path, records: Records, settings: Sequence[str] = ()) -> Midranging:
    """Return the experiment of a run, its references as they were recorded.

    Parameters
    ----------
    path : Path
        Of its folder.
    records : mapping of str to Recording
    settings : sequence of str
        Laid over its rig file.

    Raises
    ------
    ValueError : it is none, or nothing is recorded.
    """
    cell, origin = rig_file.load(path / CONFIG, CellConfig, settings), read_origin(path / RUN)
    if origin is None or not origin.designed:
        return _Older(cell, path, records)
    told = origin.designed
    chosen = {
        axis: Scenario(told["scenario"], np.zeros(1), _options(each["options"]), each["period"])
        for axis, each in told["axes"].items()
    }
    is_older = told["controller"] == ADAPTIVE and told.get("law", 1) != LAW
    made = (_OlderLaw if is_older else Midranging)(cell, told["controller"], chosen)
    runs = made.runs(records)
    for axis, run in runs.items():
        made.chosen[axis] = Scenario(
            told["scenario"], run.select(["reference"]).data[:, 0], chosen[axis].options, chosen[axis].period
        )
    return made


def _options(told: Mapping[str, Any]) -> dict[str, Any]:
    """Return keywords of the pair as they were before JSON had them."""
    return {name: tuple(map(tuple, value)) if name == "gains" else value for name, value in told.items()}


class _OlderLaw(Midranging):
    """A run of adaptive control by an earlier law: reported, but not made again."""

    def again(self, records: Records) -> Iterator[Part]:
        """Refuse: today's controller makes something else of the same sensors."""
        raise ValueError(
            "it was made by adaptive internal model control as it was before models had dead times, which this version "
            "has not any more; `stagectl report` shows it"
        )


class _Older(Midranging):
    """A run of version 0.1.0, in CSV files from the reference's first sample on: reported, but not made again."""

    def __init__(self, cell: CellConfig, path: Path, records: Records) -> None:
        if not records:
            raise ValueError(f"{path}: nothing is recorded")
        self._kept = {name.removeprefix(TRACK).removeprefix("-"): record for name, record in records.items()}
        about = next(iter(self._kept.values())).provenance
        chosen = {axis: _named(about["scenario"], each) for axis, each in self._kept.items()}
        super().__init__(cell, about["controller"], chosen)

    def runs(self, records: Records) -> dict[str, Recording]:
        """Return what was recorded."""
        return self._kept

    def again(self, records: Records) -> Iterator[Part]:
        """Refuse: what the controller did while it estimated is not recorded."""
        raise ValueError(
            "it was recorded by version 0.1.0 from the reference's first sample on: the controller's estimation phase, "
            "which a replay begins with, is not in it; `stagectl report` shows it"
        )


def _named(name: str, run: Recording) -> Scenario:
    """Return a scenario as it was recorded; what happened to the pair, where it is one of the thesis'."""
    reference = run.select(["reference"]).data[:, 0].astype(float)
    known = scenario(name, run.rate) if name in SECONDS else Scenario(name, reference)
    return Scenario(name, reference, known.options, known.period)


MIDRANGING = Kind("mid-ranging run", read_back, apart=("learning.model",))
