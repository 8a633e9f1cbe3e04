"""The command `calibrate velocity`: the robot's velocity model for `stagectl force`."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TextIO

import typer

from calibration.from_command import refuse_measuring
from calibration.milling.velocity import SIGNALS, Velocity, identify_velocity
from calibration.names import raw_folder, refuse_inputs, refuse_taken
from calibration.output import AgainOption, Output, RecomputeOption, Wish, output
from calibration.raw_run import raw_run
from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of
from rigkit import config as rig_file
from rigkit.agreement import GOING_ON, AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.disk_space import require
from rigkit.experiment.kept import records_of
from rigkit.experiment.once import Once
from rigkit.experiment.runner import Conduct
from rigkit.progress import progress
from rigkit.stop import stoppable
from rigkit.written import written_file
from stagectl.experiments.feed.free_run import WAYS, FreeRun
from stagectl.experiments.feed.job import pocket_of
from stagectl.experiments.feed.plan import FeedPlan, feed_plan
from stagectl.models.model_file import write_model
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_needless_yes, refuse_unattended
from stagectl.robot.live.led import LedRobot
from stagectl.robot.live.person import Person
from stagectl.robot.milling.feed_force import velocity_weights
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.robot.milling.velocity_loop import velocity_loop
from stagectl.wire.robot import RATE

LEAST = 4.0
"""s of steps."""
CHANNELS = 15
"""Of the recording: feed, and what the robot says."""


def velocity_command(
    out: Annotated[Path, written_file("FILE", "Model file to write; the record goes beside it.")],
    config: ConfigOption = None,
    record: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE", help=f"CSV or WAV with the channels {', '.join(SIGNALS)}, m/s."),
    ] = None,
    order: Annotated[int, typer.Option(min=1, max=8, help="States of the model.")] = 3,
    axis: Annotated[str, typer.Option(metavar="x|y", help="Axis of the base along which it feeds.")] = "x",
    seconds: Annotated[float, typer.Option(help="Of steps.")] = 24.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the steps.")] = 1,
    is_live: Annotated[bool, typer.Option("--live", help="The robot of [robot]; else the simulated one.")] = False,
    is_sure: Annotated[bool, typer.Option("--yes", help="Live: no confirmation before it moves.")] = False,
    again: AgainOption = False,
    recompute: RecomputeOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Identify the robot's response to a feed, from random steps in air, or from a record of them.

    Live, the tool is brought over the middle of the workpiece first, as [segments] has it, and steps there by up to
    35 mm to either side; Ctrl-C holds the robot.

    Examples: `calibrate velocity --config cell.toml --out velocity.h5`,
    `calibrate velocity --config cell.toml --live --out velocity.h5`
    """
    raw_folder(out)  # refuses what is no name of a model
    refuse_needless_yes(is_sure, is_live)
    if axis not in WAYS:
        raise ValueError(f"--axis is {axis!r}, must be one of {', '.join(WAYS)}")
    if not LEAST <= seconds <= 600.0:
        raise ValueError(f"--seconds is {seconds:g}, must be {LEAST:g} to 600")
    cell = rig_file.load(config, CellConfig, settings or [])
    if record is not None:
        refuse_measuring({"--live": is_live, "--recompute": recompute})
        refuse_inputs([out], [config, record])
        found = _identified(recording.read(record, rate=RATE), order, cell)
        refuse_taken([out], again)
        write_model(out, found.model)
    else:
        person = _person(cell, is_sure, words(json)) if is_live else None
        kind, made = f"calibration of velocity, {'live' if is_live else 'simulated'}", [out.with_suffix(".csv")]
        writes = output(out, kind, cell, Wish(again, recompute, accept or []), made, GOING_ON, inputs=[config])
        free = FreeRun(_plan(writes.config), axis, seconds, seed)
        found = _of_robot(writes, free, person, order, words(json))
    _tell(found, out, json)


def _person(cell: CellConfig, is_sure: bool, stream: TextIO) -> Person:
    """Return who is asked beside a live robot; ValueError where nobody can be."""
    refuse_unattended(cell, is_sure)
    return Person(partial(print, file=stream, flush=True), not is_sure)


def _of_robot(writes: Output[CellConfig], free: FreeRun, person: Person | None, order: int, stream: TextIO) -> Velocity:
    """Make the steps, or read them; identify, and write what comes of it."""
    out = writes.out
    for note in writes.notes:
        print(note, file=stream)  # noqa: T201
    if not writes.is_recomputed:
        require(out.parent, bytes_of(round(free.seconds * RATE), CHANNELS, "float64", "wav"), "the recording")
    measured = _measured(writes, free, person)
    measured = replace(measured, provenance={**measured.provenance, **writes.provenance})
    found = _identified(measured, order, writes.config)
    recording.write(out.with_suffix(".csv"), measured)
    write_model(out, found.model)
    writes.finish()
    return found


def _identified(measured: Recording, order: int, cell: CellConfig) -> Velocity:
    found = identify_velocity(measured, order)
    velocity_loop(found.model, velocity_weights(cell.force))  # a model that nothing can be designed from is told now
    return found


def _plan(cell: CellConfig) -> FeedPlan:
    pocket = pocket_of("pocket", cell.segments)
    assert pocket is not None
    return feed_plan(cell, pocket, nominal_velocity(RATE))


def _measured(writes: Output[CellConfig], free: FreeRun, person: Person | None) -> Recording:
    """Make the steps, recorded as they go, or read them; say beforehand how long that takes."""
    with writes.begun(), raw_run(writes.raw, writes.config) as folder, stoppable() as stop:
        conduct = Conduct(lambda: stop.made)
        once = Once(folder, conduct)
        if not once.has(free.name):
            if writes.is_recomputed:
                raise ValueError(f"--recompute: {writes.raw}/ has no {free.name}.wav")
            if person is not None:
                robot = LedRobot(writes.config, person)
                person.tell(f"steps: {free.seconds:.0f} s in real time")
                once.run(free.name, free.wired(robot, folder.event, conduct.stopped))
                robot.leave(folder.event, conduct.stopped)
            else:
                with progress("steps", free.seconds) as meter:
                    meter.say(
                        f"steps: {free.seconds:.0f} s of them, simulated some ten times as fast; the first time its "
                        "loops are compiled"
                    )
                    replace(once, conduct=replace(conduct, show=meter.show)).run(free.name, free.simulated())
        return free.velocities(records_of(folder.path, free.name)[free.name])


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
        ["free run, validation data", f"{figures['fresh_fit']:.1f}"],
        ["one step ahead, validation data", f"{figures['fresh_one_step']:.1f}"],
    ]
    print_table(f"{out}: order {found.model.order}", ["fit", "NRMSE, %"], rows, words(json))
    write_json(json, figures)
