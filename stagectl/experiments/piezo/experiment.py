"""A run of the stage as an experiment: its parts, simulated, live or as recorded, and what it is made of."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ctlblocks import Block
from ctlblocks import recording as files
from ctlblocks.recording import Recording, RecordingError
from ctlblocks.replay import Record
from ctlblocks.room import bytes_of
from rigkit.experiment.kind import Kind, Records
from rigkit.experiment.part import Part
from rigkit.experiment.runner import never
from rigkit.priority import undisturbed
from rigkit.run_folder import RunFolder
from stagectl.experiments.piezo.cell import (
    RECORDED,
    RECORDING,
    UNCOMPENSATED,
    Cell,
    Seen,
    channels_of,
    part_name,
    ports_of,
    recorded,
    simulated,
)
from stagectl.experiments.piezo.figures import figures, left_by
from stagectl.experiments.piezo.prefilter_file import PREFILTER, learned, write_prefilters
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.report import run_report
from stagectl.experiments.piezo.run_setup import ended_before, model_name, setup_as_run, setup_of
from stagectl.experiments.piezo.setup import Setup
from stagectl.experiments.piezo.wired import recorded_live, wired_part
from stagectl.link.stage_link import StageLink
from stagectl.link.tell import Tell, nobody
from stagectl.stage.loop_parameters import loops_as_json

LEARNED_FROM = ("absolute", "position")
"""What prefilters are made of."""
Opened = Callable[[Tell], AbstractContextManager[StageLink]]
"""Gives the link of a live run while that is on; what happens on it is told."""


class StageRun:
    """One run: without compensation first, where the rig file says so.

    Parameters
    ----------
    made : Setup
    models : sequence of Path
        Model files that its folder is to have.
    opened : Opened, optional
        Of a live run; a link of its own, unless given.
    seen : Seen, optional
        The stage of one in process; the simulated one, unless given.
    before : collection of str
        Recordings whose end a version told that had no parts.

    Attributes
    ----------
    watching : dict of str to Block
        Further sinks, by name.
    """

    def __init__(
        self,
        made: Setup,
        models: Sequence[Path] = (),
        opened: Opened | None = None,
        seen: Seen | None = None,
        before: frozenset[str] = frozenset(),
    ) -> None:
        self.made, self._models, self._before = made, tuple(models), before
        self._opened = opened or (lambda tell: StageLink(made.config.link, tell))
        self._seen = seen or simulated(made.config)
        self.watching: dict[str, Block] = {}
        self._part: Part | None = None
        self._path: Path | None = None

    @property
    def names(self) -> list[str]:
        """Names of its recordings, in the order in which they are made."""
        return [UNCOMPENSATED] * self.made.config.session.compare + [RECORDING]

    @property
    def seconds(self) -> float:
        """Of all its parts."""
        return self.made.timeline.total / self.made.timeline.rate * len(self.names)

    @property
    def about(self) -> dict[str, str]:
        """Provenance of the recordings."""
        return {"rig": self.made.config.rig.name}

    @property
    def designed(self) -> dict[str, Any]:
        """The loops, and what they were chosen for."""
        axes, designs = self.made.config.stage.axes, self.made.designs
        if not designs:
            return {}
        chosen = {
            axis: {
                "robustness": str(each.robustness),
                "worst_sensitivity": each.worst_sensitivity,
                "left": each.left,
                **asdict(each.weights),
            }
            for axis, each in zip(axes, designs, strict=True)
        }
        return {"loops": loops_as_json(axes, self.made.outer_loops), "chosen": chosen}

    @property
    def room(self) -> int:
        """Bytes that its recordings may take; one that becomes a CSV is there as a WAV first."""
        config = self.made.config
        signals = recorded_live(config) if config.session.live else RECORDED
        suffixes: list[str] = [config.session.recording] * len(self.names)
        suffixes += ["wav"] * ("csv" in suffixes)
        channels, rows = len(signals) * len(config.stage.axes), self.made.timeline.total
        return sum(bytes_of(rows, channels, "float64", suffix) for suffix in suffixes)

    def take_into(self, folder: RunFolder) -> list[str]:
        """Take the models, and a reference from a file, into the folder; what comes of the run is kept there."""
        self._path, config = folder.path, self.made.config
        axes, hysteresis = config.stage.axes, config.inner.hysteresis
        taken = {model_name(axis): file for axis, file in zip(axes, self._models, strict=bool(self._models))}
        for axis, name in zip(axes, hysteresis, strict=bool(hysteresis)):
            taken[f"hysteresis-{axis}.h5"] = Path(name)
        if config.reference.signal != "hold":
            source = Path(config.reference.signal)
            taken[f"reference{source.suffix.lower()}"] = source
        for name, file in taken.items():
            folder.take_in(file, name)
        return sorted(taken)

    def held(self) -> int:
        """Return the samples by which the part under way has become longer, since its reference was held."""
        part = self._part
        return 0 if part is None else part.late() * part.graph.frames

    def parts(self, tell: Tell = nobody, stopped: Callable[[], bool] = never) -> Iterator[Part]:  # noqa: ARG002
        """Give the parts, one after another, simulated or over the link.

        Parameters
        ----------
        tell : callable(event, fields)
        stopped : callable() -> bool
            Not asked: nothing is brought anywhere first.

        Raises
        ------
        LinkError : the bus cannot be opened, or the stage is not heard.
        """
        live = self.made.config.session.live
        with undisturbed() if live else nullcontext(), self._opened(tell) if live else nullcontext() as link:
            for name in self.names:
                learner = self._learner(name)
                try:
                    self._part = self._made_part(name, link, {**self.watching, **learner}, tell)
                    yield self._part
                finally:
                    self._part = None
                    self._convert(name, tell)
                for each in learner.values():
                    self._learn(each, tell)

    def again(self, records: Records) -> Iterator[Part]:
        """Give the parts with the sensors as they were recorded, by track; a fault comes of itself."""
        made, axes = self.made, self.made.config.stage.axes
        if made.config.session.live:
            raise ValueError("a live run's controllers ran in the stage, there is nothing to replay here")
        for name in (name for name in (UNCOMPENSATED, RECORDING) if name in records):
            record, compensate = records[name], made.config.deflection.on and name == RECORDING
            wanted = record.select([f"wanted_{axis}" for axis in axes])
            cell = Cell(made, wanted, recorded(record, made.config), compensate, {})
            part, rows = cell.part(name), len(record.data)
            if name in self._before and rows < made.timeline.total:  # it was stopped: only the way to rest is left
                at = max(rows - cell.ramp, 0)
                times = replace(made.timeline, start=min(made.timeline.start, at), end=at, total=rows)
                part = replace(part, phases=cell.phases(times))
            assert part.retreat is not None  # one in process has it
            yield replace(part, retreat=replace(part.retreat, fault=str))

    def figures(self, records: Records) -> dict[str, Any]:
        """Return what a run comes to: as of `figures.figures`."""
        return figures(records, self.made)

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report; the loops that it shows are designed again."""
        run_report(path, records, self.made if self.made.designs else setup_of(path), figures, png)

    def _made_part(self, name: str, link: StageLink | None, watching: Mapping[str, Block], tell: Tell) -> Part:
        made, wanted = self.made, wanted_position(self.made.config, self.made.timeline)
        if link is not None:
            return wired_part(link, made, name, wanted, watching, tell)
        compensate = made.config.deflection.on and name == RECORDING
        return Cell(made, wanted, self._seen, compensate, watching).part(name, tell)

    def _learner(self, name: str) -> dict[str, Record]:
        """Return what keeps what prefilters are learned from, where that recording is one to learn them from."""
        made, deflection = self.made, self.made.config.deflection
        is_learned = deflection.on and deflection.learn and bool(made.designs) and not made.prefilters
        if part_name(name) == "" or not is_learned:
            return {}
        return {"learner": Record(ports_of(LEARNED_FROM, made.config.stage.axes), made.timeline.total)}

    def _learn(self, learner: Record, tell: Tell) -> None:
        """Take prefilters for the deflection that was seen without compensation; they are kept in the folder."""
        kept, axes = learner.recording(), self.made.config.stage.axes
        seen = Recording(channels_of(LEARNED_FROM, axes), kept.units, kept.rate, kept.data)
        try:
            self.made = replace(self.made, prefilters=learned(seen, self.made))
        except ValueError as why:
            tell("note", {"text": f"no prefilter: {why}"})
            return
        if self._path is not None:
            write_prefilters(self._path / PREFILTER, axes, self.made.config.stage.rate, self.made.prefilters)
        tell("prefiltered", {"left": left_by(self.made)})

    def _convert(self, name: str, tell: Tell) -> None:
        """Convert what was recorded to the format that the rig file asks for."""
        if self.made.config.session.recording != "csv" or self._path is None:
            return
        for path in sorted(self._path.glob(f"{name}.wav")) + sorted(self._path.glob(f"{name}-[0-9]*.wav")):
            try:
                files.write(path.with_suffix(".csv"), files.read(path))
            except RecordingError as fault:
                tell("kept_as_wav", {"recording": path.name, "text": str(fault)})
            else:
                path.unlink()


def read_back(path: Path, records: Records, settings: Sequence[str] = ()) -> StageRun:  # noqa: ARG001 (a reader's)
    """Return the run of a folder: the loops that were used, or those designed anew by settings over its rig file.

    Raises
    ------
    ValueError : that is no whole run's, or settings do not fit.
    """
    made = setup_of(path, settings) if settings else setup_as_run(path)
    return StageRun(made, before=ended_before(path))


STAGE_RUN = Kind(
    "stage run",
    read_back,
    apart=("inner.hysteresis", "reference.signal"),
    reports_early=False,
    stands_in=RECORDING,
)
