"""The command `stagectl midrange`: the macro and the micro manipulator under one of the controllers."""

from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.command import (
    ConfigOption,
    JsonOption,
    PngOption,
    SetOption,
    laid_over,
    print_table,
    words,
    write_json,
)
from rigkit.common_options import one_of
from rigkit.experiment.command import CommandLine, RunOption, refuse_png_alone
from stagectl.experiments.midranging.experiment import Midranging
from stagectl.experiments.midranging.read_back import MIDRANGING
from stagectl.experiments.midranging.scenario import scenarios
from stagectl.experiments.midranging.table import table
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.controllers import CONTROLLERS

TABLE = "table-3.1"
LiveOption = Annotated[bool, typer.Option("--live", help="The robot of [robot] and the stage of [link].")]

ScenarioOption = Annotated[
    str,
    typer.Option(
        "--scenario",
        metavar="NAME",
        help="table-3.1, thesis-1, thesis-2, toroid, or a CSV or WAV file, in m.",
        autocompletion=one_of(["table-3.1", "thesis-1", "thesis-2", "toroid"]),
    ),
]


def midrange(
    scenario_name: ScenarioOption,
    controller_name: Annotated[
        str,
        typer.Option(
            "--controller",
            metavar="NAME",
            help=f"{', '.join(CONTROLLERS)}; table-3.1 runs all that it needs.",
            autocompletion=one_of(CONTROLLERS),
        ),
    ] = "aimc",
    config: ConfigOption = None,
    live: LiveOption = False,
    out: RunOption = None,
    png: PngOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run the macro and the micro manipulator: relative position, both positions, control signal, models, IAE.

    Examples: `stagectl midrange --controller aimc --scenario thesis-2 --out RUN/`,
    `stagectl midrange --config cell.toml --live --scenario toroid --out RUN/`
    """
    cell = rig_file.load(config, CellConfig, laid_over(settings, {"midranging.session.live": live}))
    refuse_png_alone(png, out)
    is_live = cell.midranging.session.live
    if scenario_name == TABLE:
        if out is not None or is_live:
            raise ValueError(f"--scenario {TABLE} makes a table and no recording: it takes no --out and no --live")
        _tell_table(table(cell.midranging), json)
        return
    made = Midranging(cell, controller_name, scenarios(scenario_name, cell.midranging.pair.rate))
    line = CommandLine("mid-ranging", is_live, out, png, json)
    reasons, found = line.carry_out(MIDRANGING, cell, made)
    _tell(found, json)
    line.end(reasons)


def _tell(found: dict[str, Any], json: str | None) -> None:
    rows = [
        ["IAE, mm s", f"{1e3 * found['iae']:.4f}"],
        ["largest control signal over its limit", f"{found['control_over_limit']:.4f}"],
        ["share of time at the limit, %", f"{100 * found['saturated_share']:.2f}"],
        ["micro manipulator, rms, mm", f"{1e3 * found['fast_rms']:.3f}"],
        ["micro manipulator, largest, mm", f"{1e3 * found['fast_peak']:.3f}"],
    ]
    if found.get("taken_over_at") is not None:
        rows.append(["valve position control took over at, s", f"{found['taken_over_at']:.2f}"])
    if "circle" in found:
        sizes = [f"{1e6 * found['circle'][key]:.1f}" for key in ("mean_absolute", "std", "largest")]
        rows.append(["off the circle: mean absolute, std, largest, um", ", ".join(sizes)])
    for each in found.get("changes", ()):
        after = f"a period after the gain is {each['gain']:g} times the first, %"
        rows.append([f"off the response with the pair known, {after}", f"{100 * each['deviation']:.3f}"])
        rows.append([f"gain off, {after}", f"{100 * each['gain_error']:.3f}"])
    print_table(f"mid-ranging, {found['seconds']:g} s", ["figure", "value"], rows, words(json))
    write_json(json, found)


def _tell_table(rows: list[dict[str, Any]], json: str | None) -> None:
    shown = [
        [row["setup"], "1", f"{row['mvpc_aw']:.3f}", f"{row['mvpc']:.3f}", f"{row['aimc_iae']:.4f}", f"{row['runs']}"]
        for row in rows
    ]
    head = ["setup", "AIMC", "MVPC + anti-windup", "MVPC", "AIMC, mm s a step", "runs"]
    print_table("IAE of steps over AIMC's", head, shown, words(json))
    write_json(json, {"setups": rows})
