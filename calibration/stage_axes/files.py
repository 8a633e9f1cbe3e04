"""The files that a calibration of the stage leaves: models, reports, and the rig file with what it has chosen."""

from collections.abc import Sequence
from pathlib import Path

from calibration.stage_axes.calibration import AxisCalibration
from calibration.stage_axes.report import axis_report
from calibration.stage_axes.rig import CHOSEN, calibrated_rig
from rigkit import atomic
from rigkit.config_edit import with_tables
from stagectl.config import StageConfig
from stagectl.models.model_file import write_model

ALL = "all"


def axes_of(rig: StageConfig, axis: str) -> list[int]:
    """Return which axes "x" or "all" stands for, counted from 0; ValueError where it is none of the stage's."""
    names = rig.stage.axes
    if axis == ALL:
        return list(range(len(names)))
    if axis not in names:
        raise ValueError(f"--axis is {axis!r}, must be {', '.join(names)} or {ALL}")
    return [names.index(axis)]


def model_file(out: Path, name: str, is_of_all: bool) -> Path:
    """Return where an axis' model goes: `out`, or of all axes stage.h5 makes stage-x.h5."""
    return out.with_stem(f"{out.stem}-{name}") if is_of_all else out


def results(rig: StageConfig, axis: str, out: Path) -> list[Path]:
    """Return all files that `write` will make, beside figures."""
    models = [model_file(out, rig.stage.axes[each], axis == ALL) for each in axes_of(rig, axis)]
    made = [path.with_stem(f"{path.stem}{part}") for path in models for part in ("", "-open", "-simo")]
    return [*made, *(path.with_suffix(".html") for path in models), out.with_suffix(".toml")]


def write(
    found: Sequence[AxisCalibration],
    out: Path,
    is_of_all: bool,
    rig: StageConfig,
    text: str,
    png: Path | None = None,
) -> None:
    """Write the models and reports of axes, and the rig file with what was chosen for them.

    Parameters
    ----------
    found : sequence of AxisCalibration
    out : Path
        Model file.
    is_of_all : bool
        Whether each axis has its name in that of its file.
    rig : StageConfig
    text : str
        Of the rig file, which is kept but for what was chosen.
    png : Path, optional
        Folder for the figures as PNG files as well.
    """
    for each in found:
        path = model_file(out, each.axis, is_of_all)
        write_model(path.with_stem(f"{path.stem}-open"), each.opened.one.model)
        write_model(path.with_stem(f"{path.stem}-simo"), each.closed.every.model)
        write_model(path, each.closed.one.model, each.closed.measured)
        report = axis_report(each, rig.rig.name)
        report.write(path.with_suffix(".html"))
        if png is not None:
            report.png(png / each.axis)
    atomic.write(out.with_suffix(".toml"), with_tables(text, calibrated_rig(rig, found), CHOSEN))
