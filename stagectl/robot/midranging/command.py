"""The command `stagectl midrange`: the macro and the micro manipulator under one of the controllers."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, application, print_table, run, words, write_json
from rigkit.provenance import now, software
from rigkit.run_folder import RunFolder
from rigkit.stop import stoppable
from stagectl.link.bus import LinkError
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.axes import Runs, all_figures, run_axes
from stagectl.robot.midranging.controllers import CONTROLLERS
from stagectl.robot.midranging.live import LiveFault
from stagectl.robot.midranging.report import PAGE, write_report
from stagectl.robot.midranging.scenario import Scenario, scenarios
from stagectl.robot.midranging.table import table

TABLE = "table-3.1"

ScenarioOption = Annotated[
    str,
    typer.Option(
        "--scenario", metavar="NAME", help="table-3.1, thesis-1, thesis-2, toroid, or a CSV or WAV file, in m."
    ),
]


def recording_name(axis: str) -> str:
    """Return how the recording of an axis is called in a run's folder."""
    return f"recording-{axis}.csv" if axis else "recording.csv"


def midrange(
    scenario_name: ScenarioOption,
    controller_name: Annotated[
        str,
        typer.Option("--controller", metavar="NAME", help=f"{', '.join(CONTROLLERS)}; table-3.1 runs all it needs."),
    ] = "aimc",
    config: ConfigOption = None,
    live: Annotated[bool, typer.Option("--live", help="The robot of [robot] and the stage of [link].")] = False,
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for recording and report.")] = None,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run the macro and the micro manipulator: relative position, both positions, control signal, models, IAE.

    Examples: `stagectl midrange --controller aimc --scenario thesis-2 --out RUN/`,
    `stagectl midrange --config cell.toml --live --scenario toroid --out RUN/`
    """
    cell = rig_file.load(config, CellConfig, [*(settings or []), *["midranging.session.live=true"] * live])
    if png is not None and out is None:
        raise ValueError("--png goes with --out RUN/, which is not given")
    if scenario_name == TABLE:
        if out is not None or cell.midranging.session.live:
            raise ValueError(f"--scenario {TABLE} makes a table and no recording: it takes no --out and no --live")
        _tell_table(table(cell.midranging), json)
        return
    chosen = scenarios(scenario_name, cell.midranging.pair.rate)
    with stoppable() as stop:
        if out is None:
            runs = run_axes(controller_name, cell, chosen, lambda: stop.made)
            _tell(all_figures(runs, chosen, cell.midranging), json)
            return
        kept = {"controller": controller_name, "scenario": scenario_name, "time": now(), "software": software()}
        with RunFolder.create(out, rig_file.dump(cell)) as folder:
            runs = _run(folder, cell, chosen, kept, lambda: stop.made)
            _tell(_keep(folder, runs, chosen, cell, kept, png), json)
    print(f"report: {out / PAGE}", file=words(json))  # noqa: T201


def _run(
    folder: RunFolder,
    cell: CellConfig,
    chosen: dict[str, Scenario],
    kept: dict[str, str],
    stopped: Callable[[], bool],
) -> Runs:
    """Run it; of a live run that a fault ends, what was recorded until then is kept as well.

    One that comes to nothing, for a setting or a wire, leaves no folder.
    """
    try:
        return run_axes(kept["controller"], cell, chosen, stopped)
    except LiveFault as fault:
        if not fault.recorded:
            folder.withdraw()
            raise
        _write(folder, dict(zip(chosen, fault.recorded, strict=False)), kept | {"fault": str(fault)})
        folder.event("fault", {"text": str(fault)})
        raise
    except (LinkError, ValueError):
        folder.withdraw()
        raise


def _keep(
    folder: RunFolder,
    runs: Runs,
    chosen: dict[str, Scenario],
    cell: CellConfig,
    kept: dict[str, str],
    png: Path | None,
) -> dict[str, Any]:
    """Write recordings, figures and report of a run into its folder; return the figures."""
    whole = _write(folder, runs, kept)
    found = all_figures(whole, chosen, cell.midranging)
    folder.summarise(found)
    write_report(folder.path, whole, chosen, cell.midranging, found, png)
    return found


def _write(folder: RunFolder, runs: Runs, kept: dict[str, str]) -> Runs:
    whole = {axis: Recording(each.names, each.units, each.rate, each.data, kept) for axis, each in runs.items()}
    for axis, each in whole.items():
        recording.write(folder.path / recording_name(axis), each)
    return whole


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
    write_json(json, rows)


def main() -> int:
    """Run the command alone and return its exit status."""
    app = application("A macro and a micro manipulator share one position.")
    app.command("midrange")(midrange)
    return run(app, "stagectl", "firmware_sim")


if __name__ == "__main__":
    sys.exit(main())
