"""A run in its folder: the stage in closed loop with the plant in process, everything recorded, measured and kept."""

import errno
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import DiskFault, bytes_of
from rigkit import config as rig_file
from rigkit.disk_space import require
from rigkit.kept_files import kept_files
from rigkit.provenance import software
from rigkit.run_folder import RunFolder
from rigkit.run_origin import keep_origin
from stagectl.config import StageConfig
from stagectl.experiments.piezo.cell import RECORDED, Cell, simulated
from stagectl.experiments.piezo.lasers import reads_laser, refuse_unfit_lasers
from stagectl.experiments.piezo.prefilter_file import PREFILTER, learned, write_prefilters
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.run_setup import model_name
from stagectl.experiments.piezo.setup import Setup, refuse_unfit_prefilters, setup
from stagectl.experiments.piezo.streamed import (
    RECORDING,
    UNCOMPENSATED,
    convert,
    recorded_live,
    recorder,
    recordings_of,
)
from stagectl.models.model_origin import refuse_foreign
from stagectl.stage.loop_parameters import loops_as_json
from stagectl.tracking import tracking

KIND = "stage run"
Tell = Callable[[str, int], None]


def create(
    path: Path, config: StageConfig, models: Sequence[Path], accept: Collection[str] = ()
) -> tuple[RunFolder, Setup]:
    """Make the folder of a new run, with copies of its models and of a reference from a file.

    Parameters
    ----------
    path : Path
    config : StageConfig
    models : sequence of Path
        Model files, one an axis; of a live run, none as well.
    accept : collection of str
        Keys in which the stage that models were measured on may differ.

    Raises
    ------
    ValueError : models, reference and settings do not fit together, or the folder is in use; nothing is written.
    OSError : there is no room on the disk for the recordings; nothing is written.
    """
    made = setup(config, models)
    made = replace(made, said=tuple(refuse_foreign(config, models, made.models, accept)))
    return make_folder(path, made, models, accept), made


def make_folder(path: Path, made: Setup, models: Sequence[Path], accept: Collection[str] = ()) -> RunFolder:
    """Make the folder of a run of that setup, with the same copies, and the same errors."""
    config = made.config
    _refuse_ignored(config)
    refuse_unfit_lasers(config)
    if config.deflection.prefilter and not made.designs:
        raise ValueError("deflection.prefilter is set, must not be without models: it belongs to loops made of them")
    wanted_position(config, made.timeline)
    made.compensation()
    if made.prefilters:
        refuse_unfit_prefilters(made)
    _require_space(path, made)
    files = kept_files(config, ["inner.hysteresis", "reference.signal"])
    with RunFolder.filled(path, rig_file.dump(files.config)) as folder:
        copied = files.take_into(folder)
        for axis, model in zip(config.stage.axes, models, strict=bool(models)):
            folder.take_in(model, model_name(axis))
        for axis, file in zip(config.stage.axes, config.inner.hysteresis, strict=bool(config.inner.hysteresis)):
            folder.take_in(Path(file), f"hysteresis-{axis}.h5")
        if config.reference.signal != "hold":
            source = Path(config.reference.signal)
            folder.take_in(source, f"reference{source.suffix.lower()}")
        parts = [path.name for path in folder.path.iterdir() if path.suffix in (".h5", ".wav", ".csv")]
        loops = {"loops": loops_as_json(config.stage.axes, made.outer_loops) if made.designs else {}}
        keep_origin(folder, KIND, files.config, [*sorted(parts), *copied], sorted(accept), loops)
    return folder


def _refuse_ignored(config: StageConfig) -> None:
    """Refuse what a live run would pass over in silence."""
    ignored = {
        "inner.hysteresis": (bool(config.inner.hysteresis), "the stage's processor undoes no hysteresis"),
    }
    for key, (is_set, why) in ignored.items():
        if config.session.live and is_set:
            raise ValueError(f"{key} is set, must not be where session.live is true: {why}; the simulated stage does")


def run(folder: RunFolder, made: Setup, tell: Tell, stopped: Callable[[], bool]) -> dict[str, Any]:
    """Run it, without compensation first where the rig file says so; return the figures, also in `summary.json`.

    Parameters
    ----------
    folder : RunFolder
    made : Setup
    tell : callable(str, int)
        Told which recording is being made, and of the samples done.
    stopped : callable() -> bool
    """
    config = made.config
    wanted = wanted_position(config, made.timeline)
    folder.event("started", {"software": software(), **designed(made)})
    for name in recordings_of(config):
        fault = _recorded(folder, made, wanted, name, lambda done, name=name: tell(name, done), stopped)  # type: ignore[misc]
        if fault is not None or stopped():
            break
        made = prefiltered_after(folder, made, name)
    figures = summary(folder.path, made)
    folder.summarise(figures)
    return figures


def prefiltered_after(folder: RunFolder, made: Setup, name: str) -> Setup:
    """Return a setup with prefilters, where that recording is one to learn them from; kept in the folder.

    Parameters
    ----------
    folder : RunFolder
    made : Setup
    name : str
    """
    deflection = made.config.deflection
    is_learned = deflection.on and deflection.learn and bool(made.designs) and not made.prefilters
    if name != UNCOMPENSATED or not is_learned:
        return made
    kept = read_recording(folder.path, name)
    assert kept is not None  # it has just been written
    return _prefiltered(folder, made, kept)


def _recorded(
    folder: RunFolder,
    made: Setup,
    wanted: Recording,
    name: str,
    tell: Callable[[int], None],
    stopped: Callable[[], bool],
) -> str | None:
    """Run it once, recorded as it goes; return its fault."""
    config = made.config
    kept = recorder(folder, config, RECORDED, name, has_thread=False)
    cell = Cell(made, wanted, simulated(config), config.deflection.on and name == RECORDING, {"record": kept})

    def told(done: int) -> None:
        kept.drain_when_due()
        if kept.lost:
            raise DiskFault(errno.ENOSPC, kept.fault or os.strerror(errno.ENOSPC), str(folder.path))
        tell(done)

    with kept:
        fault = cell.run(told, stopped)
    convert(folder, config, kept)
    tell_recorded(folder, name, cell, kept.recorded)
    return fault


def _prefiltered(folder: RunFolder, made: Setup, record: Recording) -> Setup:
    """Return a setup with prefilters for the deflection that was recorded without compensation; kept in the folder."""
    try:
        made = replace(made, prefilters=learned(record, made))
    except ValueError as why:
        folder.event("note", {"text": f"no prefilter: {why}"})
        return made
    write_prefilters(folder.path / PREFILTER, made.config.stage.axes, made.config.stage.rate, made.prefilters)
    folder.event("prefiltered", {"left": left_by(made)})
    return made


def left_by(made: Setup) -> dict[str, dict[str, float]]:
    """Return what each axis' loop leaves of the deflection that its prefilter is made for, `left` and `without` it."""
    pairs = zip(made.config.stage.axes, made.prefilters, strict=bool(made.prefilters))
    return {axis: {"left": each.left, "without": each.without} for axis, each in pairs if each is not None}


def summary(path: Path, made: Setup) -> dict[str, Any]:
    """Return the figures of a run that other programs read.

    Parameters
    ----------
    path : Path
        Its folder.
    made : Setup

    Returns
    -------
    dict
        `seconds` of the run proper that are recorded; `position_error` (reference less position) and `tool_error`
        (wanted less laser), each for each axis: mae, std, peak (m) and within (1); where it was also run
        uncompensated, `uncompensated_tool_error` and `improvement`, the ratio of the mean absolute errors, by axis;
        `prefilter`, as of `left_by`, where there is one.
    """
    record = read_recording(path, RECORDING)
    figures: dict[str, Any] = {"seconds": 0.0}
    if record is not None and len(record.data) > made.timeline.begin:
        figures["seconds"] = len(record.data[made.timeline.proper]) / record.rate
        live = made.config.session.live
        if not (live and made.config.deflection.on):  # what the stage compensates it keeps to itself
            figures["position_error"] = _measures(record, made, "reference", "position")
        if not live or reads_laser(made.config):
            figures["tool_error"] = _measures(record, made, wanted_name(made), "absolute")
    before = read_recording(path, UNCOMPENSATED)
    if before is not None and len(before.data) > made.timeline.begin:
        figures["uncompensated_tool_error"] = _measures(before, made, wanted_name(made), "absolute")
        if "tool_error" in figures:
            pairs = figures["uncompensated_tool_error"], figures["tool_error"]
            figures["improvement"] = {axis: pairs[0][axis]["mae"] / pairs[1][axis]["mae"] for axis in pairs[1]}
    if made.prefilters:
        figures["prefilter"] = left_by(made)
    return figures


def read_recording(path: Path, name: str) -> Recording | None:
    """Read a recording of a run, or return None if there is none of this name."""
    files = [path / f"{name}.{suffix}" for suffix in ("csv", "wav") if (path / f"{name}.{suffix}").exists()]
    return recording.read(files[0]) if files else None


def wanted_name(made: Setup) -> str:
    """Return the signal that says where the tool is wanted: of a live run, what was sent to the stage.

    Parameters
    ----------
    made : Setup
    """
    return "reference" if made.config.session.live else "wanted"


def error_of(record: Recording, made: Setup, wanted: str, measured: str) -> np.ndarray:
    """Return the error over the run proper, shape (samples, axes), m: the channels `wanted` less those `measured`.

    Parameters
    ----------
    record : Recording
    made : Setup
    wanted, measured : str
    """
    axes = made.config.stage.axes
    parts = [record.select([f"{name}_{axis}" for axis in axes]).data for name in (wanted, measured)]
    error: np.ndarray = (parts[0] - parts[1])[made.timeline.proper]
    return error


def _measures(record: Recording, made: Setup, wanted: str, measured: str) -> dict[str, dict[str, float]]:
    error = error_of(record, made, wanted, measured)
    return {axis: asdict(tracking(column)) for axis, column in zip(made.config.stage.axes, error.T, strict=True)}


def _require_space(path: Path, made: Setup) -> None:
    """Refuse a run whose recordings the disk cannot hold."""
    session, signals = made.config.session, len(RECORDED)
    suffixes: list[str] = [session.recording] * (1 + session.compare)
    if session.live:
        signals = len(recorded_live(made.config))
        suffixes = suffixes + ["wav"] * (session.recording == "csv")
    samples, channels = made.timeline.total, signals * len(made.config.stage.axes)
    needed = sum(bytes_of(samples, channels, "float64", suffix) for suffix in suffixes)
    require(path, needed, f"{samples / made.timeline.rate:g} s of {channels} channels")


def tell_recorded(folder: RunFolder, name: str, cell: Cell, samples: int) -> None:
    """Tell what was recorded of a run in process, which limits it met, and its fault."""
    if cell.stage.fault is not None:
        folder.event("fault", {"recording": name, "text": cell.stage.fault, "sample": samples})
    met = asdict(cell.stage.controller.met) | {"guard": cell.stage.guard.limited, "held": cell.stage.sensors.held}
    folder.event("recorded", {"recording": name, "samples": samples, "limits_met": met})


def designed(made: Setup) -> Mapping[str, Any]:
    """Return what the outer loops of each axis keep, for the run's log."""
    return {
        axis: {
            "robustness": str(each.robustness),
            "worst_sensitivity": each.worst_sensitivity,
            "left": each.left,
            **asdict(each.weights),
        }
        for axis, each in zip(made.config.stage.axes, made.designs, strict=True)
    }
