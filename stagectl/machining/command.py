"""The command `stagectl cell`: the toroid in steel, by robot alone, with a tracker, with the stage."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, print_table, words, write_json
from rigkit.disk_space import require
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from stagectl.machining import session
from stagectl.machining.plan import RATE, SETUPS, designs_of, plan, stage_of
from stagectl.machining.report import HEAD, PAGE, cell_report, table_rows
from stagectl.machining.run import Conduct, offline, paced
from stagectl.machining.surroundings import refuse_wrong_plants
from stagectl.robot.config import CellConfig

ALL = "all"


def cell(
    setup: Annotated[str, typer.Option(metavar="SETUP", help=f"{', '.join(SETUPS)}; {ALL} for one after the other.")],
    out: Annotated[Path, typer.Option(metavar="RUN/", help="Folder to make for recordings and report.")],
    config: ConfigOption = None,
    stage: Annotated[Path | None, typer.Option(metavar="FILE", help="The stage's own rig file.")] = None,
    model: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Model file of a stage's axis; give one for each of x, y, z, or none."),
    ] = None,
    is_paced: Annotated[bool, typer.Option("--paced", help="In real time; else as fast as it goes.")] = False,
    png: PngOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Mill the toroid: accuracy as in Table 2.3, contours, surface, and what the stage used of its travel.

    C-fixed is C without mid-ranging: it runs into the ends of the stage's travel.

    Example: `stagectl cell --setup all --config cell.toml --out RUN/ --png figures/`
    """
    files = session.Files(rig_file.load(config, CellConfig, settings or []), stage_of(stage), model or ())
    for note in session.refuse_foreign_models(files, accept or ()):
        sys.stderr.write(f"{note}\n")
    pace = paced if is_paced else offline
    setups = list(SETUPS) if setup == ALL else [setup]
    designs = designs_of(files.stage, files.models) if any(each.startswith("C") for each in setups) else []
    plans = [plan(each, files.cell, files.stage, designs) for each in setups]
    for made in plans:
        refuse_wrong_plants(made)
    require(out, sum(map(session.room, plans)), f"{len(plans)} of the setups")
    with session.create(out, files, accept or ()) as folder, stoppable() as stop:
        for made in plans:
            with progress(
                f"setup {made.setup}, {made.path.seconds:.0f} s of motion", round(made.path.seconds * RATE)
            ) as meter:
                session.run(folder, made, Conduct(folder.event, lambda: stop.made, meter.show, pace))
            if stop.made:
                raise Stopped(f"stopped; what is recorded is in {folder.path}")
        rows = cell_report(folder.path, png)
    _tell(rows, out, setup == ALL, json)


def _tell(rows: list[dict[str, Any]], path: Path, is_table: bool, json: str | None) -> None:
    print_table(f"{path}: the toroid in steel", HEAD, table_rows(rows), words(json))
    print(f"report: {path / PAGE}", file=words(json))  # noqa: T201
    write_json(json, {"setups": rows} if is_table else rows[0])
