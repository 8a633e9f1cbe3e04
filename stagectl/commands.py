"""The commands of `stagectl`."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, PngOption, SetOption, print_table, words, write_json
from rigkit.json_file import json_value
from rigkit.origin import RUN, read_origin
from rigkit.progress import progress
from rigkit.retention_command import prune_command
from rigkit.run_folder import RunFolder, make_whole
from rigkit.run_origin import say_at_work
from rigkit.stop import Stopped, stoppable
from stagectl import session
from stagectl.application import app
from stagectl.changed import say_changed
from stagectl.config import StageConfig
from stagectl.export import export
from stagectl.feed.command import force
from stagectl.feed.folder import is_of_feed, replay_folder, report_folder
from stagectl.link.stage_link import StageLink
from stagectl.live import run_live
from stagectl.machining.command import cell
from stagectl.machining.replay import replay_cell
from stagectl.machining.report import cell_report
from stagectl.machining.session import is_of_cell
from stagectl.planning.command import plan
from stagectl.planning.example_pocket import EXAMPLE_POCKET
from stagectl.replay import Replayed, replay
from stagectl.report import run_report
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.command import midrange
from stagectl.robot.midranging.session import KIND as MIDRANGING
from stagectl.robot.milling.force_command import estimate_force_command
from stagectl.scenario import scenario_settings
from stagectl.setup import Setup
from stagectl.trials.command import ilc
from stagectl.trials.job import report_again
from stagectl.trials.replay import replay_trials
from stagectl.trials.session import is_of_trials

RunArgument = Annotated[Path, typer.Argument(metavar="RUN/", help="Folder of a run.")]


@app.command("example-config")
def example_config(json: JsonOption = None) -> None:
    """Print a complete rig file for the simulator: every key with its unit, range and default.

    Example: `stagectl example-config > stage.toml`
    """
    words(json).write(rig_file.example(StageConfig))
    write_json(json, StageConfig().model_dump(mode="json"))


@app.command("example-cell")
def example_cell(json: JsonOption = None) -> None:
    """Print a complete file of the robot cell: every key with its unit, range and default.

    Example: `stagectl example-cell > cell.toml`
    """
    words(json).write(rig_file.example(CellConfig))
    write_json(json, CellConfig().model_dump(mode="json"))


@app.command("example-pocket")
def example_pocket(json: JsonOption = None) -> None:
    """Print a pocket for the planners: the wood of chapter 7.

    Example: `stagectl example-pocket > POCKET.json`
    """
    words(json).write(EXAMPLE_POCKET)
    write_json(json, json_value(EXAMPLE_POCKET, "the example", dict))


@app.command("run")
def run_command(
    out: Annotated[Path, typer.Option(metavar="RUN/", help="Folder to make for the run.")],
    model: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Model file of an axis; give one for each, in the order of stage.axes."),
    ] = None,
    config: ConfigOption = None,
    reference: Annotated[
        str | None, typer.Option(help="hold, or a WAV or CSV file of positions in m, a channel an axis.")
    ] = None,
    seconds: Annotated[float | None, typer.Option(help="Length of the run.")] = None,
    scenario: Annotated[str | None, typer.Option(help="milling-x, milling-y or milling-z.")] = None,
    seed: Annotated[int | None, typer.Option(help="Which simulated stage.")] = None,
    live: Annotated[bool, typer.Option("--live", help="The stage behind its CAN adapter.")] = False,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Run the stage in closed loop, record it, and end with a report.

    Example: `stagectl run --config stage.toml --model x.h5 --model y.h5 --model z.h5 --reference ref.csv --out RUN/`
    """
    flags = {"reference.signal": reference, "session.seconds": seconds, "simulator.options.seed": seed}
    given = [f"{key}={value}" for key, value in flags.items() if value is not None]
    given += ["session.live=true"] * live
    laid_over = [*(settings or []), *given]
    made = rig_file.load(config, StageConfig, laid_over)
    if made.session.live and scenario is not None:
        raise ValueError("--live runs the stage on what is there: --scenario is for the simulator")
    if made.session.live and seed is not None:
        raise ValueError("--live runs the stage on what is there: --seed is for the simulator")
    if scenario is not None:
        made = rig_file.load(config, StageConfig, [*scenario_settings(scenario, made.session), *laid_over])
    folder, put_together = session.create(out, made, model or [], accept or [])
    sys.stderr.write("".join(f"{note}\n" for note in put_together.said))
    with folder:
        _end(_run(folder, put_together), out, json)


def _run(folder: RunFolder, made: Setup) -> dict[str, Any]:
    seconds = made.timeline.total / made.timeline.rate
    with stoppable() as stop, progress(f"running for {seconds:g} s", made.timeline.total) as meter:
        if made.config.session.live:
            meter.say(f"{seconds:g} s in real time")  # and no more: nothing is printed while the stage is led
            figures = run_live(folder, made, lambda: stop.made)
        else:
            figures = session.run(folder, made, lambda name, done: meter.show(done, name), lambda: stop.made)
    if stop.made:
        raise Stopped(f"stopped; what is recorded is in {folder.path}")
    run_report(folder.path)
    return figures


def _end(figures: dict[str, Any], path: Path, json: str | None) -> None:
    rows = []
    for what in ("position_error", "tool_error", "uncompensated_tool_error"):
        for axis, each in figures.get(what, {}).items():
            sizes = [f"{1e6 * each[key]:.2f}" for key in ("mae", "std", "peak")]
            rows.append([f"{what.replace('_', ' ')}, {axis}", *sizes, f"{100 * each['within']:.1f}"])
    head = ["error", "MAE, um", "std, um", "peak, um", "within 5 um, %"]
    print_table(f"{path}: {figures['seconds']:g} s", head, rows, words(json))
    for axis, factor in figures.get("improvement", {}).items():
        print(f"{axis}: {factor:.1f} times better than uncompensated", file=words(json))
    if figures.get("lost"):
        print(f"{figures['lost']} samples are not recorded: the disk was too slow, or full", file=words(json))
    if (path / "report.html").exists():
        print(f"report: {path / 'report.html'}", file=words(json))
    write_json(json, figures)


@app.command("replay")
def replay_command(
    path: RunArgument,
    json: JsonOption = None,
) -> None:
    """Make every output of a run again from its recorded sensors; status 1 if one differs from the recorded one.

    Example: `stagectl replay RUN/`
    """
    _refuse_mid_ranging(path)
    say_changed(path)
    say_at_work(path)
    done = _collected(_replayed(path))
    rows = [
        [each.recording, each.channel, "yes" if each.identical else "no", f"{each.difference:.3g} {each.unit}"]
        for each in done
    ]
    print_table(
        f"{path}: outputs made again from the recorded sensors",
        ["recording", "channel", "bit for bit", "largest difference"],
        rows,
        words(json),
    )
    differ = sum(not each.identical for each in done)
    write_json(json, {"channels": len(done), "differing": differ})
    if differ:
        raise typer.Exit(1)


def _refuse_mid_ranging(path: Path) -> None:
    origin = read_origin(path / RUN)
    if origin is not None and origin.kind == MIDRANGING:
        raise ValueError(
            f"{path}/ is a {MIDRANGING}: its report was written when it ended, and neither that nor the run is made "
            f"again; `stagectl export {path}` takes its recordings"
        )


def _collected(replayed: Iterator[Replayed]) -> list[Replayed]:
    """Return what was made again; say beforehand how long that takes, and then each recording that is done."""
    sys.stderr.write("making every recording again takes about as long as a simulation of the run\n")
    done: list[Replayed] = []
    for each in replayed:
        if not done or done[-1].recording != each.recording:
            sys.stderr.write(f"made again: {each.recording}\n")
        done.append(each)
    return done


def _reported(path: Path, png: Path | None) -> dict[str, Any]:
    if is_of_feed(path):
        return report_folder(path, png)
    if is_of_trials(path):
        return report_again(path, png)
    return {"setups": cell_report(path, png)} if is_of_cell(path) else run_report(path, png)


def _replayed(path: Path) -> Iterator[Replayed]:
    if is_of_feed(path):
        return replay_folder(path)
    if is_of_trials(path):
        return replay_trials(path)
    return replay_cell(path) if is_of_cell(path) else replay(path, session.setup_of(path))


@app.command("report")
def report_command(
    path: RunArgument,
    png: PngOption = None,
    json: JsonOption = None,
) -> None:
    """Draw the report of a run again.

    Example: `stagectl report RUN/ --png figures/`
    """
    make_whole(path)
    _refuse_mid_ranging(path)
    say_changed(path)
    say_at_work(path)
    figures = _reported(path, png)
    print(f"report: {path / 'report.html'}", file=words(json))
    write_json(json, figures)


@app.command("acknowledge")
def acknowledge_command(
    by: Annotated[str, typer.Option(metavar="NAME", help="The person who found out why it happened.")],
    config: ConfigOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """End a fault of the stage behind its CAN adapter, so that it can be started again.

    Example: `stagectl acknowledge --config stage.toml --by "A. Person"`
    """
    made = rig_file.load(config, StageConfig, settings or [])
    with StageLink(made.link) as link:
        reason = link.acknowledge(by)
    print(f"{by} has acknowledged: {reason}", file=words(json))
    write_json(json, {"by": by, "fault": reason})


app.command("midrange")(midrange)
app.command("cell")(cell)
app.command("plan")(plan)
app.command("estimate-force")(estimate_force_command)
app.command("ilc")(ilc)
app.command("export")(export)
app.command("prune")(prune_command)
app.command("force")(force)
