"""A step or a multisine on robot, stage, or one after the other: what is run, simulated, live or as recorded."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import Graph
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from ctlblocks.room import bytes_of
from ctlblocks.taps import Tap
from rigkit import config as rig_file
from rigkit.experiment.kind import Kind, Records
from rigkit.experiment.part import Part, Phase, Track
from rigkit.experiment.runner import never
from rigkit.origin import RUN, read_origin
from rigkit.priority import undisturbed
from rigkit.run_folder import CONFIG
from stagectl.experiments.midranging import pairs, wired
from stagectl.experiments.midranging.graph import ASKED, MEASURED
from stagectl.experiments.midranging.wired_blocks import LivePair
from stagectl.experiments.step.report import write_report
from stagectl.experiments.step.response import MANIPULATORS, Wanted, figures
from stagectl.link.clock import Linked
from stagectl.link.tell import Tell, nobody
from stagectl.robot.config import CellConfig

TRACK = "steps"


class Steps:
    """One axis of the pair of mid-ranging, without a controller over it.

    Parameters
    ----------
    cell : CellConfig
    wanted : Wanted

    Raises
    ------
    ValueError : a multisine without lines, a stage asked beyond its travel; live, another rate than the robot's, or
        more than the stage's wire carries.

    Attributes
    ----------
    pair : LivePair or None
        Both manipulators while their wires are open.
    """

    def __init__(self, cell: CellConfig, wanted: Wanted) -> None:
        self.cell, self.config, self.wanted = cell, cell.midranging, wanted
        self.is_live = self.config.session.live
        self.axes: list[str] = [self.config.session.axis]
        self.pair: LivePair | None = None
        self._one = wanted.excitation(self.config.pair.rate)
        travel = self.config.pair.travel
        if "stage" in wanted.manipulators and not wanted.size <= travel:
            raise ValueError(f"size is {wanted.size:g} m, must be <= midranging.pair.travel, {travel:g} m")
        if self.is_live:
            wired.refuse_unfit(self.config, self.axes)

    @property
    def seconds(self) -> float:
        """Of all of it."""
        return len(self._one) * len(self.wanted.manipulators) / self.config.pair.rate

    @property
    def about(self) -> dict[str, str]:
        """Provenance of the recording."""
        return {"kind": self.wanted.kind, "of": self.wanted.of}

    @property
    def designed(self) -> dict[str, Any]:
        """What was asked."""
        return self.wanted.model_dump(include=set(Wanted.model_fields))

    @property
    def room(self) -> int:
        """Bytes that its recording may take."""
        rows = len(self._one) * len(self.wanted.manipulators)
        return bytes_of(rows, len(ASKED) + len(MEASURED), "float64", "wav")

    def parts(
        self,
        tell: Tell = nobody,  # noqa: ARG002 (robot and stage cannot wait for a disk)
        stopped: Callable[[], bool] = never,  # noqa: ARG002 (nothing is brought anywhere first)
    ) -> Iterator[Part]:
        """Give its part, simulated or with the wires open; LinkError for a wire that cannot be had."""
        if not self.is_live:
            yield self._part(pairs.simulated(self.config, {}))
            return
        with undisturbed(), wired.opened(self.cell, self.axes) as pair:
            self.pair = pair
            try:
                made = self._part(pairs.wired(pair, self.config.session.smoothing))
                first, *others = made.phases
                begun = replace(first, begin=partial(wired.start, pair))
                yield replace(made, phases=(begun, *others), clock=Linked(pair.robot), rest=pair.rest)
            finally:
                self.pair = None

    def again(self, records: Records) -> Iterator[Part]:
        """Give its part with the pair as it was recorded."""
        for record in records.values():
            yield self._part(pairs.recorded(record, {name: [name] for name in MEASURED}))

    def figures(self, records: Records) -> dict[str, Any]:
        """Return what is read off: as of `response.figures`."""
        if TRACK not in records:
            raise ValueError("nothing is recorded")
        return figures(records[TRACK], self.wanted)

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report."""
        write_report(path, records[TRACK], self.wanted, figures, png)

    def _part(self, make: pairs.Pair) -> Part:
        """Return the part: what is asked of each manipulator in turn, from rest."""
        rate, names, count = self.config.pair.rate, self.wanted.manipulators, len(self._one)
        asked = np.zeros((count * len(names), len(ASKED)))
        for number, name in enumerate(names):
            column = ASKED.index(f"{MANIPULATORS[name]}_reference")
            asked[number * count : (number + 1) * count, column] = self._one
        asked[:, ASKED.index("fast_reference")] += self.config.pair.middle
        graph = Graph(rate)
        there = make(graph)
        played = Recording(ASKED, ("m",) * len(ASKED), rate, asked)
        graph.add("asked", Replay(played, {name: (name,) for name in ASKED}))
        for name in ASKED if there.sink is not None else ():
            graph.connect(f"asked.{name}", f"{there.sink}.{name}")
        taps = (*(Tap(name, f"asked.{name}") for name in ASKED), *there.seen.values())
        phases = tuple(Phase(name, count) for name in names)
        return Part("", graph, (Track(TRACK, taps, frozenset(ASKED)),), phases)


def read_back(path: Path, records: Records, settings: Sequence[str] = ()) -> Steps:  # noqa: ARG001 (a reader's)
    """Return the experiment of a run's folder, with settings laid over its rig file; ValueError where it is none."""
    origin = read_origin(path / RUN)
    if origin is None or not origin.designed:
        raise ValueError(f"{path}: does not say what was asked")
    return Steps(rig_file.load(path / CONFIG, CellConfig, settings), Wanted(**origin.designed))


STEPS = Kind("step responses", read_back, apart=("learning.model",))
