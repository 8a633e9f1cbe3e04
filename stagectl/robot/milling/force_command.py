"""The command `stagectl estimate-force`: forces on the tool from a log of motor torques."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.written import made_folder, written_file
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.force_estimate import TIE_BREAKS, ForceEstimates
from stagectl.robot.milling.force_interval import ForceIntervals, force_intervals
from stagectl.robot.milling.force_plot import AXES, force_plot
from stagectl.robot.milling.torque_check import refuse_other_torques
from stagectl.robot.milling.torque_file import read_force_model
from stagectl.robot.milling.torque_log import TorqueLog, read_torque_log
from stagectl.robot.port import arm_of

PICTURE = "force.png"


def estimate_force_command(
    log: Annotated[Path, typer.Argument(metavar="LOG.csv", help="Time (s), six angles, six torques (N m) a line.")],
    model: Annotated[Path, typer.Option(metavar="FILE", help="Gravity, friction and inertia, of `calibrate milling`.")],
    out: Annotated[Path, written_file("FILE", "CSV file to write, a line a sample.")],
    config: ConfigOption = None,
    angles: Annotated[str | None, typer.Option(metavar="deg|rad", help="Unit of the log's angles; else deg.")] = None,
    tie_break: Annotated[
        str | None, typer.Option(metavar="|".join(TIE_BREAKS), help="Choice among equally likely forces.")
    ] = None,
    png: Annotated[Path | None, made_folder("DIR", f"Draw the forces as {PICTURE}.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Estimate the force on the tool, with its bounds, from the motor torques in a signal log.

    Angles and torques are the motors', converted to the joints' side of the gears, as `robot.signals` gives them.
    Gaps are left empty, and reported.

    Example: `stagectl estimate-force torque.csv --model milling.h5 --out force.csv --png figures/`
    """
    if out.suffix != ".csv" or not out.parent.is_dir():
        raise ValueError(f"--out {out}: must end in '.csv' and lie in a folder that is there")
    cell = rig_file.load(config, CellConfig, settings or [])
    arm = arm_of(cell).with_tool(cell.robot.tool)
    made = read_force_model(model, arm, cell.force_estimate)
    made = replace(made, tie_break=tie_break or made.tie_break)
    read = read_torque_log(log, arm, angles)
    refuse_other_torques(read, made)
    found = made.estimate(read.joint_angle, read.torque, read.rate)
    likely = force_intervals(made, found, read.joint_angle, read.torque, read.rate)
    atomic.write(out, force_table(read.time, found, likely))
    if png is not None:
        with atomic.folder(png), atomic.replacing(png / PICTURE) as temporary:
            force_plot(read.time, found).savefig(temporary)
    figures = force_figures(read, found, likely)
    names = "mean", "rms", "peak", "width", "width_95"
    rows = [[f"{axis}, N", *(f"{figures[axis][name]:.2f}" for name in names)] for axis in AXES]
    head = ["force on the tool", "mean", "rms", "peak", "median width of its bounds", "of its 95 % interval"]
    print_table(f"{log}: {len(read.time)} samples at {read.rate:g} a second", head, rows, words(json))
    for text in _remarks(read, figures):
        print(text, file=words(json))  # noqa: T201
    write_json(json, figures)


def force_table(time: np.ndarray, found: ForceEstimates, likely: ForceIntervals) -> str:
    """Return the CSV file's text; cells are empty where nothing is determined.

    Parameters
    ----------
    time : array, shape (samples,), s
    found : ForceEstimates
    likely : ForceIntervals
    """
    names = [f"{what}_{axis} [N]" for what in ("force", "lower", "upper") for axis in AXES]
    beside = [f"{what}_95_{axis} [N]" for what in ("lower", "upper") for axis in AXES]
    table = np.column_stack([found.force, found.low, found.high])
    lines = [",".join(["time [s]", *names, "unique [1]", "objective [1]", *beside])]
    ends = np.column_stack([likely.low, likely.high])
    for at, row, unique, objective, end in zip(time, table, found.unique, found.objective, ends, strict=True):
        told = [f"{each:.9g}" for each in row] + [f"{int(unique)}", f"{objective:.9g}"]
        told += [f"{each:.9g}" for each in end]
        lines.append(",".join([f"{at:.9g}", *(told if np.isfinite(objective) else [""] * len(told))]))
    return "\n".join(lines) + "\n"


def force_figures(log: TorqueLog, found: ForceEstimates, likely: ForceIntervals) -> dict[str, Any]:
    """Return what `--json` writes: of every axis mean, rms, peak and median widths (N), and what the log lacks."""
    told = np.isfinite(found.objective)
    figures: dict[str, Any] = {
        "samples": len(told),
        "rate": log.rate,
        "gaps": log.gaps,
        "missing": log.missing,
        "undetermined": int((~told).sum()) - log.missing,
        "unique": float(found.unique[told].mean()) if told.any() else 0.0,
        "by_friction_alone": float((found.objective[told] == 0).mean()) if told.any() else 0.0,
    }
    for place, axis in enumerate(AXES):
        force, width = found.force[told, place], (found.high - found.low)[told, place]
        narrow = (likely.high - likely.low)[told, place]
        some = force if len(force) else np.array([np.nan])
        figures[axis] = {
            "mean": float(some.mean()),
            "rms": float(np.sqrt(np.mean(some**2))),
            "peak": float(np.abs(some).max()),
            "width": float(np.median(width)) if len(width) else np.nan,
            "width_95": float(np.median(narrow)) if len(narrow) else np.nan,
        }
    return figures


def _remarks(log: TorqueLog, figures: dict[str, Any]) -> list[str]:
    found = []
    if log.gaps:
        times = "gap" if log.gaps == 1 else "gaps"
        found.append(
            f"{log.gaps} {times}, {log.missing} samples, {log.missing / log.rate:.3g} s in all, are left empty"
        )
    if figures["undetermined"]:
        found.append(
            f"{figures['undetermined']} samples give no force: a joint is faster than friction is known, or the arm is "
            "singular"
        )
    return found
