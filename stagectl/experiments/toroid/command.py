"""The command `stagectl cell`: the toroid in steel, by robot alone, with a tracker, with the stage."""

import sys
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any

import typer

from ctlblocks.clock import Offline, Paced
from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.command import CommandLine, refuse_given
from rigkit.experiment.resumed import GoingOn
from rigkit.run_folder import CONFIG
from stagectl.experiments.toroid.experiment import Confirm, Toroid
from stagectl.experiments.toroid.plan import ALL, SETUPS, stage_of
from stagectl.experiments.toroid.read_back import TOROID, Files, left_of, plans_of, setup_of_track, was_live
from stagectl.experiments.toroid.report import HEAD, table_rows
from stagectl.robot.config import CellConfig
from stagectl.robot.live.guide import refuse_another_arm, refuse_needless_yes, refuse_unattended
from stagectl.robot.live.person import Person

SETUP_HELP = f"{', '.join(SETUPS)}; {ALL} for one after the other"
ResumeOption = Annotated[
    Path | None,
    typer.Option(metavar="RUN/", help="Continue that run with its settings: the remaining setups."),
]
ModelsOption = Annotated[
    list[Path] | None,
    typer.Option(metavar="FILE", help="Model file of a stage's axis; give one for each of x, y, z, or none."),
]
LiveOption = Annotated[
    bool, typer.Option("--live", help="The robot of [robot], [tracker], and in setups C the stage of [link].")
]
SetupOption = Annotated[
    str | None,
    typer.Option(
        metavar="SETUP",
        help=f"{SETUP_HELP}.",
        autocompletion=one_of([*SETUPS, ALL]),
    ),
]


def cell(
    setup: SetupOption = None,
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for recordings and report.")] = None,
    resume: ResumeOption = None,
    config: ConfigOption = None,
    stage: Annotated[Path | None, typer.Option(metavar="FILE", help="The stage's own rig file.")] = None,
    model: ModelsOption = None,
    is_paced: Annotated[bool, typer.Option("--paced", help="In real time; else as fast as possible.")] = False,
    is_live: LiveOption = False,
    is_sure: Annotated[
        bool, typer.Option("--yes", help="With --live: no confirmation before the robot moves.")
    ] = False,
    png: PngOption = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Mill the toroid: accuracy as in Table 2.3, contours, surface, and what the stage used of its travel.

    C-fixed is C without mid-ranging: it runs into the ends of the stage's travel.

    Live, the robot must be near where the path begins; it asks before it moves, and what was cut is measured
    afterwards: the figures are of what tracker and stage have seen.

    Examples: `stagectl cell --setup all --config cell.toml --out RUN/ --png figures/`,
    `stagectl cell --setup B --config cell.toml --live --out RUN/`, `stagectl cell --resume RUN/`
    """
    clock = Paced() if is_paced else Offline()
    if resume is not None:
        given = {"--setup": setup, "--out": out, "--config": config, "--stage": stage, "--model": model}
        refuse_given({**given, "--set": settings, "--live": is_live or None})
        _go_on(CommandLine("the toroid", was_live(resume), resume, png, json, clock), resume, is_sure, accept or ())
        return
    if setup is None or out is None:
        raise ValueError(f"--setup is missing: {SETUP_HELP}" if setup is None else "--out is missing: the run's folder")
    refuse_needless_yes(is_sure, is_live)
    if is_live and is_paced:
        raise ValueError("--paced and --live are given, must be one of them: live, the robot is the clock")
    made, files = rig_file.load(config, CellConfig, settings or []), Files(stage_of(stage), model or ())
    for note in files.refuse_foreign(accept or ()):
        sys.stderr.write(f"{note}\n")
    if is_live:
        _refuse_unfit(made, is_sure)
    experiment = Toroid(plans_of(setup, made, files, is_live), confirm=_confirming(is_sure))
    line = CommandLine("the toroid", is_live, out, png, json, clock)
    reasons, found = line.carry_out(TOROID, made, experiment, take_more=files.take_into, accept=sorted(accept or ()))
    _tell(found["setups"], out, setup == ALL, json)
    line.end(reasons)


def _refuse_unfit(cell: CellConfig, is_sure: bool) -> None:
    refuse_another_arm(cell, "toroid.arm", cell.toroid.arm)
    refuse_unattended(cell, is_sure)


def _confirming(is_sure: bool) -> Confirm:
    """Return what has a person at the terminal confirm each live setup, or says alone what comes."""
    return lambda what, stopped: Person(_say, not is_sure).confirm(what, stopped)


def _go_on(line: CommandLine, path: Path, is_sure: bool, accept: Collection[str]) -> None:
    refuse_needless_yes(is_sure, line.is_live)
    if line.is_live:
        refuse_unattended(rig_file.load(path / CONFIG, CellConfig), is_sure)
    way = GoingOn(CellConfig, lambda done: left_of(path, done, _confirming(is_sure)), setup_of_track, accept, _say)
    reasons, found = line.go_on(TOROID, way)
    _tell(found["setups"], path, True, line.json)
    line.end(reasons)


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def _tell(rows: list[dict[str, Any]], path: Path, is_table: bool, json: str | None) -> None:
    print_table(f"{path}: the toroid in steel", HEAD, table_rows(rows), words(json))
    write_json(json, {"setups": rows} if is_table else rows[0])
