"""The command `calibrate milling`."""

from pathlib import Path
from typing import Annotated

import typer

from calibration.milling.report import FIT_HEAD, figures, fit_rows, milling_report
from calibration.milling.session import calibrate, dry_run
from calibration.milling.sweep_session import sweep, sweep_steps
from calibration.raw_folder import raw_folder
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.stop import stoppable
from stagectl.machining.run import Conduct
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import write_milling
from stagectl.robot.milling.torque_file import UNITS
from stagectl.trials.session import Runner, run_simulated
from stagectl.trials.trial import TASKS, cell_for_task

SWEEP = "sweep.wav"


def milling_command(
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Model file; recordings and report beside it.")
    ] = None,
    config: ConfigOption = None,
    task: Annotated[str, typer.Option(metavar="TASK", help=f"{', '.join(TASKS)}.")] = "pocket28",
    dry: Annotated[bool, typer.Option("--dry-run", help="Print every motion, and make none.")] = False,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Find how the robot follows, its friction and gravity, and how milling pushes it aside: G_R, G_M, G_K.

    A sweep through the workspace, chirps above the workpiece, trials of the path in the air until it is learned, and
    one in material.  Stopped or killed, the same command goes on from there.

    Example: `calibrate milling --config cell.toml --out milling.h5`
    """
    cell = cell_for_task(rig_file.load(config, CellConfig, settings or []), task)
    if dry:
        moves = [*(step.words for step in sweep_steps(cell)), *dry_run(cell, task)]
        for number, each in enumerate(moves, start=1):
            typer.echo(f"{number:3d}  {each}")
        return
    if out is None:
        raise ValueError("--out is missing: recordings are kept beside the model file")
    stream = words(json)

    def tell(text: str) -> None:
        print(text, file=stream, flush=True)  # noqa: T201

    with _raw(out, cell) as folder, stoppable() as stop:
        swept = sweep(cell, False, folder.path / SWEEP, tell, stop)
        run = Runner(folder, Conduct(folder.event, lambda: stop.made), run_simulated, tell)
        found = calibrate(cell, task, run, swept)
    write_milling(out, found.models, UNITS)
    report = milling_report(found, str(out))
    report.write(out.with_suffix(".html"))
    if png is not None:
        report.png(png)
    print_table(f"{out}: fits on what was held back, %", FIT_HEAD, fit_rows(found), stream)
    tell(f"report: {out.with_suffix('.html')}")
    write_json(json, figures(found))


def _raw(out: Path, cell: CellConfig) -> RunFolder:
    """Make the folder of raw recordings, or take it up again where it is of the same configuration."""
    path, text = raw_folder(out), rig_file.dump(cell)
    if not (path / CONFIG).exists():
        return RunFolder.create(path, text)
    if (path / CONFIG).read_text(encoding="utf-8") != text:
        raise ValueError(f"{path}/ was recorded with another configuration; choose another name for the model")
    return RunFolder.open(path)
