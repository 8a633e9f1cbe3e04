"""The command `calibrate velocity`: the robot's velocity model for `stagectl force`."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from calibration.milling.velocity import SIGNALS, Velocity, identify_velocity
from calibration.names import raw_folder, refuse_inputs, refuse_taken
from calibration.output import AgainOption, provenance
from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.config_files import sums_of
from rigkit.disk_space import require
from rigkit.progress import progress
from rigkit.provenance import now
from rigkit.written import written_file
from stagectl.experiments.feed.free_run import WAYS, free_run
from stagectl.experiments.feed.job import pocket_of
from stagectl.experiments.feed.plan import feed_plan
from stagectl.models.model_file import write_model
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.feed_force import velocity_weights
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.robot.milling.velocity_loop import velocity_loop
from stagectl.wire.egm import RATE

LEAST = 4.0
"""s of steps."""


def velocity_command(
    out: Annotated[Path, written_file("FILE.h5", "Model file to write; the record goes beside it.")],
    config: ConfigOption = None,
    record: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE", help=f"CSV or WAV with the channels {', '.join(SIGNALS)}, m/s."),
    ] = None,
    order: Annotated[int, typer.Option(min=1, max=8, help="States of the model.")] = 3,
    axis: Annotated[str, typer.Option(metavar="x|y", help="Along which axis of the base it feeds.")] = "x",
    seconds: Annotated[float, typer.Option(help="Of steps.")] = 24.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the steps.")] = 1,
    again: AgainOption = False,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Identify how the robot follows a feed, from random steps with the tool in the air, or from a record of them.

    Example: `calibrate velocity --config cell.toml --out velocity.h5`
    """
    raw_folder(out)  # refuses what is no name of a model
    if axis not in WAYS:
        raise ValueError(f"--axis is {axis!r}, must be one of {', '.join(WAYS)}")
    if not LEAST <= seconds <= 600.0:
        raise ValueError(f"--seconds is {seconds:g}, must be {LEAST:g} to 600")
    cell = rig_file.load(config, CellConfig, settings or [])
    made = [out] if record is not None else [out, out.with_suffix(".csv")]
    refuse_inputs(made, [config, record])
    if record is None:
        require(out.parent, bytes_of(round(seconds * RATE), len(SIGNALS), "float64", "csv"), "the record")
        refuse_taken(made, again)
        measured = _measured(cell, axis, seconds, seed, out.with_suffix(".csv"))
    else:
        measured = recording.read(record, rate=RATE)
    found = identify_velocity(measured, order)
    velocity_loop(found.model, velocity_weights(cell.force))  # a model that nothing can be designed from is told now
    if record is not None:
        refuse_taken(made, again)
    write_model(out, found.model)
    _tell(found, out, json)


def _measured(cell: CellConfig, axis: str, seconds: float, seed: int, file: Path) -> Recording:
    """Make the steps and keep the record with all that it is of; say beforehand how long that takes."""
    pocket = pocket_of("pocket", cell.segments)
    assert pocket is not None
    plan = feed_plan(cell, pocket, nominal_velocity(RATE))
    with progress("steps", round(seconds * RATE)) as meter:
        meter.say(
            f"steps: {seconds:g} s of them, simulated some ten times as fast; the first time its loops are compiled"
        )
        measured = free_run(plan, axis, seconds, seed, meter.show)
    about = {**provenance(cell, now(), sums_of(cell)), "axis": axis, "seed": str(seed)}
    measured = replace(measured, provenance={**measured.provenance, **about})
    recording.write(file, measured)
    return measured


def _tell(found: Velocity, out: Path, json: str | None) -> None:
    figures: dict[str, Any] = {
        "order": found.model.order,
        "poles": [[float(pole.real), float(pole.imag)] for pole in found.model.poles],
        "own_fit": float(found.own.free_run.nrmse[0]),
        "fresh_fit": float(found.fresh.free_run.nrmse[0]),
        "fresh_one_step": float(found.fresh.one_step.nrmse[0]),
    }
    rows = [
        ["free run, own data", f"{figures['own_fit']:.1f}"],
        ["free run, held back", f"{figures['fresh_fit']:.1f}"],
        ["one step ahead, held back", f"{figures['fresh_one_step']:.1f}"],
    ]
    print_table(f"{out}: order {found.model.order}", ["fit", "NRMSE, %"], rows, words(json))
    write_json(json, figures)
