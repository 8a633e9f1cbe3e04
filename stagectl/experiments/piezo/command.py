"""`stagectl run`."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.command import CommandLine
from rigkit.experiment.kept import reported, told
from rigkit.experiment.runner import STOPPED
from stagectl.config import StageConfig
from stagectl.experiments.piezo.experiment import STAGE_RUN, StageRun
from stagectl.experiments.piezo.fit import new_setup
from stagectl.experiments.piezo.scenario import scenario_settings


def run_command(
    out: Annotated[Path, typer.Option(metavar="RUN/", help="Folder to make for the run.")],
    model: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Model file of an axis; give one for each, in the order of stage.axes."),
    ] = None,
    config: ConfigOption = None,
    reference: Annotated[
        str | None,
        typer.Option(
            help="hold, or a WAV or CSV file of positions in m, a channel an axis.", autocompletion=one_of(["hold"])
        ),
    ] = None,
    seconds: Annotated[float | None, typer.Option(help="Length of the run.")] = None,
    scenario: Annotated[
        str | None, typer.Option(metavar="milling-x|milling-y|milling-z", help="Simulated disturbance.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the simulated stage.")] = None,
    live: Annotated[bool, typer.Option("--live", help="The stage behind its CAN adapter.")] = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run the stage in closed loop, record it, and end with a report.

    Example: `stagectl run --config stage.toml --model x.h5 --model y.h5 --model z.h5 --reference ref.csv --out RUN/`
    """
    flags = {"reference.signal": reference, "session.seconds": seconds, "simulator.options.seed": seed}
    over = laid_over(settings, {**flags, "session.live": live})
    made = rig_file.load(config, StageConfig, over)
    if made.session.live and seed is not None:
        raise ValueError("--live runs the stage on what is there: --seed is for the simulator")
    if scenario is not None:
        made = rig_file.load(config, StageConfig, [*scenario_settings(scenario, made.session), *over])
    run = StageRun(new_setup(made, model or [], accept or []), model or [])
    sys.stderr.write("".join(f"{note}\n" for note in run.made.said))
    line = CommandLine("running", made.session.live, out, None, json)
    reasons, figures = line.carry_out(STAGE_RUN, made, run, take_more=run.take_into, accept=sorted(accept or []))
    if reasons and STOPPED not in reasons.values():
        reported(out, STAGE_RUN)
    _tell(figures, out, json)
    line.end(reasons)


def _tell(figures: dict[str, Any], path: Path, json: str | None) -> None:
    rows = []
    for what in ("position_error", "tool_error", "uncompensated_tool_error"):
        for axis, each in figures.get(what, {}).items():
            sizes = [f"{1e6 * each[key]:.2f}" for key in ("mae", "std", "peak")]
            rows.append([f"{what.replace('_', ' ')}, {axis}", *sizes, f"{100 * each['within']:.1f}"])
    head = ["error", "MAE, um", "std, um", "peak, um", "within 5 um, %"]
    print_table(f"{path}: {figures['seconds']:g} s", head, rows, words(json))
    for axis, factor in figures.get("improvement", {}).items():
        said = f"{factor:.1f} times better" if factor >= 1 else f"{1 / factor:.1f} times worse"
        print(f"{axis}: {said} than uncompensated", file=words(json))
    for axis, each in figures.get("prefilter", {}).items():
        print(
            f"{axis}: foreseen to be left of the deflection: {100 * each['left']:.0f} % with its prefilter, "
            f"{100 * each['without']:.0f} % without",
            file=words(json),
        )
    if lost := sum(event["lost"] for event in told(path, "ended").values()):
        print(f"{lost} samples are not recorded: the disk was too slow, or full", file=words(json))
    write_json(json, figures)
