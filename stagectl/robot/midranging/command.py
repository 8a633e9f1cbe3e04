"""The command `stagectl midrange`: the macro and the micro manipulator under one of the controllers."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, application, print_table, run, words, write_json
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.controllers import CONTROLLERS, controller
from stagectl.robot.midranging.measures import figures
from stagectl.robot.midranging.report import PAGE, write_report
from stagectl.robot.midranging.scenario import scenario
from stagectl.robot.midranging.simulation import simulate
from stagectl.robot.midranging.table import table

TABLE = "table-3.1"
RECORDING = "recording.csv"


def midrange(
    scenario_name: Annotated[
        str,
        typer.Option("--scenario", metavar="NAME", help="table-3.1, thesis-1, thesis-2, or a CSV or WAV file, in m."),
    ],
    controller_name: Annotated[
        str,
        typer.Option("--controller", metavar="NAME", help=f"{', '.join(CONTROLLERS)}; table-3.1 runs all it needs."),
    ] = "aimc",
    config: ConfigOption = None,
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for recording and report.")] = None,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run the macro and the micro manipulator: relative position, both positions, control signal, models, IAE.

    Example: `stagectl midrange --controller aimc --scenario thesis-2 --out RUN/`
    """
    made = rig_file.load(config, MidrangeConfig, settings or [])
    if png is not None and out is None:
        raise ValueError("--png goes with --out RUN/, which is not given")
    if scenario_name == TABLE:
        if out is not None:
            raise ValueError(f"--scenario {TABLE} makes a table and no recording: it takes no --out")
        _tell_table(table(made), json)
        return
    chosen = scenario(scenario_name, made.pair.rate)
    if out is None:
        _tell(figures(simulate(controller(controller_name, made), chosen, made), chosen, made), json)
        return
    done = simulate(controller(controller_name, made), chosen, made)
    kept = {"controller": controller_name, "scenario": scenario_name, "time": now(), "software": software()}
    whole = Recording(done.names, done.units, done.rate, done.data, kept)
    with RunFolder.create(out, rig_file.dump(made)) as folder:
        recording.write(folder.path / RECORDING, whole)
        found = figures(whole, chosen, made)
        folder.summarise(found)
        write_report(folder.path, whole, chosen, made, found, png)
    _tell(found, json)
    print(f"report: {out / PAGE}", file=words(json))  # noqa: T201


def _tell(found: dict[str, Any], json: str | None) -> None:
    rows = [
        ["IAE, mm s", f"{1e3 * found['iae']:.4f}"],
        ["largest control signal over its limit", f"{found['control_over_limit']:.4f}"],
        ["share of time at the limit, %", f"{100 * found['saturated_share']:.2f}"],
        ["micro manipulator, rms, mm", f"{1e3 * found['fast_rms']:.3f}"],
        ["micro manipulator, largest, mm", f"{1e3 * found['fast_peak']:.3f}"],
    ]
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
    write_json(json, rows)


def main() -> int:
    """Run the command alone and return its exit status."""
    app = application("A macro and a micro manipulator share one position.")
    app.command("midrange")(midrange)
    return run(app, "stagectl", "firmware_sim")


if __name__ == "__main__":
    sys.exit(main())
