"""The command `stagectl midrange`: the macro and the micro manipulator under one of the controllers."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from ctlblocks import Graph
from ctlblocks.clock import run_offline
from rigkit import config as rig_file
from rigkit.command import (
    ConfigOption,
    JsonOption,
    PngOption,
    SetOption,
    application,
    laid_over,
    print_table,
    run,
    words,
    write_json,
)
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging import session
from stagectl.robot.midranging.axes import all_figures, run_axes
from stagectl.robot.midranging.controllers import CONTROLLERS, controller
from stagectl.robot.midranging.report import PAGE
from stagectl.robot.midranging.scenario import Scenario, scenarios
from stagectl.robot.midranging.simulation import Advance
from stagectl.robot.midranging.table import table

TABLE = "table-3.1"

ScenarioOption = Annotated[
    str,
    typer.Option(
        "--scenario", metavar="NAME", help="table-3.1, thesis-1, thesis-2, toroid, or a CSV or WAV file, in m."
    ),
]


def midrange(
    scenario_name: ScenarioOption,
    controller_name: Annotated[
        str,
        typer.Option("--controller", metavar="NAME", help=f"{', '.join(CONTROLLERS)}; table-3.1 runs all it needs."),
    ] = "aimc",
    config: ConfigOption = None,
    live: Annotated[bool, typer.Option("--live", help="The robot of [robot] and the stage of [link].")] = False,
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for recording and report.")] = None,
    png: PngOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run the macro and the micro manipulator: relative position, both positions, control signal, models, IAE.

    Examples: `stagectl midrange --controller aimc --scenario thesis-2 --out RUN/`,
    `stagectl midrange --config cell.toml --live --scenario toroid --out RUN/`
    """
    cell = rig_file.load(config, CellConfig, laid_over(settings, {"midranging.session.live": live}))
    if png is not None and out is None:
        raise ValueError("--png goes with --out RUN/, which is not given")
    if scenario_name == TABLE:
        if out is not None or cell.midranging.session.live:
            raise ValueError(f"--scenario {TABLE} makes a table and no recording: it takes no --out and no --live")
        _tell_table(table(cell.midranging), json)
        return
    chosen = scenarios(scenario_name, cell.midranging.pair.rate)
    with stoppable() as stop, _watched(cell, chosen) as advance:
        if out is None:
            runs = run_axes(controller_name, cell, chosen, lambda: stop.made, advance)
            _tell(all_figures(runs, chosen, cell.midranging), json)
            _end_if(stop.made, "")
            return
        kept = session.about(controller_name, scenario_name)
        session.require_room(out, controller(controller_name, cell.midranging, len(chosen)), chosen)
        with session.create(out, cell) as folder:
            runs = session.recorded(
                folder, lambda: run_axes(controller_name, cell, chosen, lambda: stop.made, advance), chosen, kept
            )
            _tell(session.keep(folder, runs, chosen, cell, kept, png), json)
    print(f"report: {out / PAGE}", file=words(json))  # noqa: T201
    _end_if(stop.made, f"; what is recorded is in {out}/")


def _end_if(is_stopped: bool, where: str) -> None:
    if is_stopped:
        raise Stopped(f"stopped: these are the figures of what was run until then{where}")


@contextmanager
def _watched(cell: CellConfig, chosen: Mapping[str, Scenario]) -> Iterator[Advance]:
    """Say how long it takes, and show how far what is simulated is; while a robot is led nothing is printed."""
    lead, rate = cell.midranging.session.lead, cell.midranging.pair.rate
    lengths, done = [round(lead * rate) + len(each.reference) for each in chosen.values()], 0
    if cell.midranging.session.live:
        sys.stderr.write(f"mid-ranging: {max(lengths) / rate:g} s in real time\n")
        yield run_offline
        return
    with progress("mid-ranging", sum(lengths)) as meter:

        def advance(graph: Graph, ticks: int) -> None:
            nonlocal done
            run_offline(graph, ticks)
            done += ticks
            meter.show(done)

        yield advance


def _tell(found: dict[str, Any], json: str | None) -> None:
    rows = [
        ["IAE, mm s", f"{1e3 * found['iae']:.4f}"],
        ["largest control signal over its limit", f"{found['control_over_limit']:.4f}"],
        ["share of time at the limit, %", f"{100 * found['saturated_share']:.2f}"],
        ["micro manipulator, rms, mm", f"{1e3 * found['fast_rms']:.3f}"],
        ["micro manipulator, largest, mm", f"{1e3 * found['fast_peak']:.3f}"],
    ]
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


def main() -> int:
    """Run the command alone and return its exit status."""
    app = application("A macro and a micro manipulator share one position.")
    app.command("midrange")(midrange)
    return run(app, "stagectl", "firmware_sim")


if __name__ == "__main__":
    sys.exit(main())
