"""The command `calibrate milling`."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from calibration.milling.live import live_steps, refuse_unfit
from calibration.milling.report import FIT_HEAD, figures, fit_rows, milling_report
from calibration.milling.session import (
    Calibrated,
    calibrate,
    dry_run,
    motion_seconds,
    output_of,
    raw_trials,
    require_room,
)
from calibration.milling.sweep_session import is_swept, sweep, sweep_steps
from calibration.output import AgainOption, Output, RecomputeOption, Wish
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.runner import Conduct
from rigkit.stop import Stopped, stoppable
from rigkit.written import written_file
from stagectl.experiments.trials.command import PACES
from stagectl.experiments.trials.runner import Runner
from stagectl.experiments.trials.trial import TASKS, cell_for_task
from stagectl.experiments.trials.wired import bench
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_needless_yes
from stagectl.robot.live.person import Person
from stagectl.robot.milling.milling_models import write_milling
from stagectl.robot.milling.torque_file import UNITS

Tell = Callable[[str], None]


def milling_command(
    out: Annotated[Path | None, written_file("FILE", "Model file; recordings and report beside it.")] = None,
    config: ConfigOption = None,
    task: Annotated[
        str, typer.Option(metavar="TASK", help=f"{', '.join(TASKS)}.", autocompletion=one_of(TASKS))
    ] = "pocket28",
    is_live: Annotated[bool, typer.Option("--live", help="The robot of [robot]; else the simulated cell.")] = False,
    is_sure: Annotated[bool, typer.Option("--yes", help="Live: no confirmation between motions.")] = False,
    dry: Annotated[bool, typer.Option("--dry-run", help="Print every motion; nothing moves.")] = False,
    png: PngOption = None,
    again: AgainOption = False,
    recompute: RecomputeOption = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Identify the robot's response, friction and gravity, and its deflection under milling forces: G_R, G_M, G_K.

    A sweep through the workspace, chirps above the workpiece, air cuts of the path until it is learned, and one trial
    in material.  After a stop or kill the same command continues there.

    Live, it asks before the sweep and before each trial.  Ctrl-C in a trial lifts the tool out.

    Examples: `calibrate milling --config cell.toml --out milling.h5`,
    `calibrate milling --config cell.toml --live --out milling.h5`
    """
    refuse_needless_yes(is_sure, is_live)
    cell = cell_for_task(rig_file.load(config, CellConfig, settings or []), task, is_live)
    moves = [*(step.words for step in sweep_steps(cell)), *dry_run(cell, task), *(live_steps(cell) if is_live else ())]
    if dry:
        typer.echo("\n".join(f"{number:3d}  {each}" for number, each in enumerate(moves, start=1)))
        return
    if out is None:
        raise ValueError("--out is missing: the model file, beside which recordings are stored")
    if is_live:
        refuse_unfit(cell, is_sure)
    writes = output_of(out, cell, Wish(again, recompute, accept or []), is_live, config)
    if not recompute:
        require_room(out, cell, task)
    stream = words(json)

    def tell(text: str) -> None:
        print(text, file=stream, flush=True)  # noqa: T201

    for note in writes.notes:
        tell(note)
    found = _measured(writes, task, is_live, is_sure, tell)
    write_milling(out, found.models, UNITS)
    writes.finish()
    _report(found, out, png, json)


def _report(found: Calibrated, out: Path, png: Path | None, json: str | None) -> None:
    for note in found.notes:
        print(note, file=words(json))  # noqa: T201
    report = milling_report(found, str(out))
    report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    print_table(f"{out}: fits on validation data, %", FIT_HEAD, fit_rows(found), words(json))
    words(json).write(f"report: {out.with_suffix('.html')}\n")
    write_json(json, figures(found))


def _measured(writes: Output[CellConfig], task: str, is_live: bool, is_sure: bool, tell: Tell) -> Calibrated:
    """Make all motions, or go on with them, and fit all models."""
    cell, about = writes.config, writes.provenance
    if not writes.is_recomputed:
        tell(f"{motion_seconds(cell, task) / 60:.0f} min of motions, {PACES[is_live]}; not again what is recorded")
    with raw_trials(writes) as folder, stoppable() as stop:
        conduct = Conduct(lambda: stop.made)
        person = Person(tell, not is_sure) if is_live else None
        if person is not None and not is_swept(folder):
            what = f"the sweep, {len(sweep_steps(cell))} motions: no block, nobody in the cell"
            person.confirm(what, conduct.stopped)
        try:
            swept, made = sweep(cell, is_live, folder, tell, conduct), bench(cell, person)
            found = calibrate(cell, task, Runner(folder, made, conduct, tell), swept, about)
            made.leave(folder.event, conduct.stopped)
            return found
        except Stopped:
            raise Stopped(writes.left) from None
