"""Mid-ranging as an experiment: its parts, simulated, live or as recorded, and what it was given."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import Block, Port
from ctlblocks.recording import Recording
from ctlblocks.replay import numbered
from ctlblocks.room import bytes_of
from rigkit.experiment.kind import Records
from rigkit.experiment.part import Part
from rigkit.experiment.runner import never
from rigkit.priority import undisturbed
from stagectl.experiments.midranging import pairs, wired
from stagectl.experiments.midranging.figures import all_figures
from stagectl.experiments.midranging.graph import MEASURED, of_axes
from stagectl.experiments.midranging.report import write_report
from stagectl.experiments.midranging.scenario import Scenario
from stagectl.experiments.midranging.schedule import TRACK, lead_of, led, part, unchecked, with_lead, without_lead
from stagectl.experiments.midranging.wired_blocks import LivePair
from stagectl.link.clock import Linked
from stagectl.link.tell import Tell, nobody
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging_config import MidrangeConfig

Runs = dict[str, Recording]
"""By the axis' name, which is empty where there is one axis only."""


LAW = 3
"""Of what a controller makes of its inputs: a run of adaptive control by an earlier one is not made again."""


class Midranging:
    """One controller on every axis: each simulated by itself, or all together behind their wires.

    Parameters
    ----------
    cell : CellConfig
    name : str
        Of the controller, one of `CONTROLLERS`.
    chosen : mapping of str to Scenario
        By axis.

    Raises
    ------
    ValueError : another controller, settings that do not fit together; live, an axis that the stage has not, another
        rate than the robot's, or more than the stage moves.

    Attributes
    ----------
    pair : LivePair or None
        Both manipulators while their wires are open.
    """

    def __init__(self, cell: CellConfig, name: str, chosen: Mapping[str, Scenario]) -> None:
        self.cell, self.config, self.name, self.chosen = cell, cell.midranging, name, dict(chosen)
        self.is_live = self.config.session.live
        self.axes = [axis or self.config.session.axis for axis in chosen] if self.is_live else list(chosen)
        self.pair: LivePair | None = None
        self.controller(len(chosen))
        if self.is_live:
            wired.refuse_unfit(self.config, self.axes)

    @property
    def lead(self) -> int:
        """Samples before the reference begins."""
        return lead_of(self.config)

    @property
    def seconds(self) -> float:
        """Of all parts."""
        lengths = [self.lead + len(each.reference) for each in self.chosen.values()]
        return (max(lengths) if self.is_live else sum(lengths)) / self.config.pair.rate

    @property
    def about(self) -> dict[str, str]:
        """Provenance of the recordings."""
        return {"controller": self.name, "scenario": next(iter(self.chosen.values())).name}

    @property
    def designed(self) -> dict[str, Any]:
        """What a run is made again from, beside its rig file and its recordings, as JSON has it."""
        done = {axis: {"options": each.options, "period": each.period} for axis, each in self.chosen.items()}
        return {**self.about, "law": LAW, "axes": done}

    @property
    def room(self) -> int:
        """Bytes that its recordings may take."""
        made = self.controller(1)
        channels = 1 + len(MEASURED) + sum(port.width for port in made.outputs)
        rows = sum(self.lead + len(each.reference) for each in self.chosen.values())
        return bytes_of(rows, channels, "float64", "wav")

    def controller(self, axes: int) -> Block:
        """Return the controller, at its beginning."""
        return controller(self.name, self.config, axes)

    def parts(
        self,
        tell: Tell = nobody,
        stopped: Callable[[], bool] = never,  # noqa: ARG002 (nothing is brought anywhere first)
    ) -> Iterator[Part]:
        """Give the parts, one after another, simulated or with their wires open.

        Parameters
        ----------
        tell : callable(event, fields)
            Told when valve position control takes over; of a live pair once it is at rest, since its tick cannot wait
            for a disk.
        stopped : callable() -> bool

        Raises
        ------
        LinkError : a wire that cannot be had.
        """
        if self.is_live:
            yield from self._live(tell)
            return
        for number, (axis, each) in enumerate(self.chosen.items()):
            pair = pairs.simulated(_of_axis(self.config, number), each.options)
            yield part(self.config, self.controller(1), self._wanted([axis]), pair, axis, tell=tell)

    def again(self, records: Records) -> Iterator[Part]:
        """Give the parts with the pair as it was recorded, by track."""
        for track, record in records.items():
            name, axes = _part_of(track), self._axes_of(track)
            ends = [f"_{axis}" if self._is_shared else "" for axis in axes]
            channels = {each: [f"{each}{end}" for end in ends] for each in MEASURED}
            wanted = record.select([f"reference{end}" for end in ends]).data.astype(float)
            pair = pairs.recorded(record, channels)
            controls, channels_of = self.controller(len(axes)), self._channels(axes)
            yield unchecked(part(self.config, controls, wanted, pair, name, channels_of))

    def runs(self, records: Records) -> Runs:
        """Return what was recorded from the first sample of the reference on, an axis each, by track."""
        found = {}
        for track, record in records.items():
            for axis in self._axes_of(track) if len(record.data) > self.lead else ():
                end = f"_{axis}" if self._is_shared else ""
                kept = without_lead(record.select([name for name in record.names if name.endswith(end)]), self.config)
                found[axis] = replace(kept, names=tuple(name.removesuffix(end) for name in kept.names))
        return found

    def figures(self, records: Records) -> dict[str, Any]:
        """Return what a run comes to: as of `all_figures`."""
        runs = self.runs(records)
        if not runs:
            raise ValueError("nothing is recorded of the reference: it had not begun")
        return all_figures(runs, {axis: self.chosen[axis] for axis in runs}, self.config)

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report."""
        write_report(path, self.runs(records), self.chosen, self.config, figures, png)

    @property
    def _is_shared(self) -> bool:
        """Whether one recording has several axes."""
        return self.is_live and len(self.chosen) > 1

    def _wanted(self, axes: Sequence[str]) -> np.ndarray:
        """Return the references of some axes, with the lead, shape (samples, axes), m."""
        return with_lead(np.stack([self.chosen[axis].reference for axis in axes], axis=1), self.config)

    def _axes_of(self, track: str) -> list[str]:
        """Return the axes that a recording has."""
        return list(self.chosen) if self.is_live else [_part_of(track)]

    def _channels(self, axes: Sequence[str]) -> Callable[[Port], tuple[str, ...]]:
        return of_axes(axes) if len(axes) > 1 else numbered

    def _live(self, tell: Tell) -> Iterator[Part]:
        axes = list(self.chosen)
        events: list[tuple[str, Mapping[str, Any]]] = []
        wired.compile_kernel(self.controller(len(axes)))
        try:
            with undisturbed(), wired.opened(self.cell, self.axes) as pair:
                self.pair = pair
                make = pairs.wired(pair, self.config.session.smoothing)
                clock, begin = Linked(pair.robot), partial(wired.start, pair)
                controls, wanted = self.controller(len(axes)), self._wanted(axes)
                channels = self._channels(axes)
                made = part(self.config, controls, wanted, make, "", channels, lambda *event: events.append(event))
                yield led(made, clock, begin, pair.rest)
        finally:
            self.pair = None
            for event in events:
                tell(*event)


def _part_of(track: str) -> str:
    """Return the name of the part that a recording is of."""
    return track.removeprefix(TRACK).removeprefix("-")


def _of_axis(config: MidrangeConfig, number: int) -> MidrangeConfig:
    """Return the settings of an axis: another seed for each one, so that their noise is not the same."""
    if number == 0:
        return config
    options = {**config.simulator.options, "seed": config.simulator.options.get("seed", 1) + number}
    return config.model_copy(update={"simulator": config.simulator.model_copy(update={"options": options})})
