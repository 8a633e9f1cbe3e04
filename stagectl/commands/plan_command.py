"""The command `stagectl plan`: pockets are planned one after the other, or a path is held against a pocket."""

from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.command import ConfigOption, JsonOption, SetOption, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.runner import Conduct
from rigkit.progress import progress
from rigkit.stop import Stopped, stoppable
from rigkit.written import written_file
from stagectl.experiments.feed.simulated import simulated_pockets
from stagectl.planning.exact import least_time
from stagectl.planning.milling import Milled, Planner, mill, total
from stagectl.planning.pocket import PLANNERS, UNTRAINED, Pocket, check, planner, untrained
from stagectl.planning.pocket_file import read_path, read_pocket, write_path
from stagectl.planning.report import TYPE_HEAD, learned_types, type_rows, write_report
from stagectl.planning.segment_file import read_segments, write_segments
from stagectl.planning.toolpath import Cutting, gcode, rapid
from stagectl.robot.config import CellConfig

PocketFile = Annotated[Path, typer.Argument(metavar="POCKET.json", help="The pocket, its tool and its costs.")]
PathFile = Annotated[Path | None, typer.Argument(metavar="PATH.json", help="With --check: the path.")]
Check = Annotated[bool, typer.Option("--check", help="Check that PATH.json mills the pocket.")]
Name = Annotated[
    str, typer.Option("--planner", metavar="NAME", help=f"{', '.join(PLANNERS)}.", autocompletion=one_of(PLANNERS))
]
Count = Annotated[int, typer.Option("--pockets", min=1, help="Number of pockets, learning from each to the next.")]
Untrained = Annotated[
    bool, typer.Option("--untrained", help=f"The planner does not know the rates: {', '.join(UNTRAINED)}.")
]
Learn = Annotated[Path | None, typer.Option(metavar="SEGMENTS.csv", help="Learn from recorded segments first.")]
PriorFile = Annotated[
    Path | None,
    written_file("FILE", "uncertain stores the errors of its rates in FILE, and learns their scales.", "--prior"),
]
Record = Annotated[Path | None, written_file("SEGMENTS.csv", "Write every finished segment.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed of the planner's random numbers.")]
Out = Annotated[Path | None, written_file("PATH.json", "Write the path of the last pocket.")]
GCode = Annotated[Path | None, written_file("FILE", "Write it as G-code.", "--gcode")]
Rapid = Annotated[Path | None, written_file("FILE", "Write it as a RAPID module.", "--rapid")]
Cell = Annotated[float, typer.Option(help="Side of a cell, m, in G-code and RAPID.")]
Depth = Annotated[float, typer.Option(help="Depth of the cut, m, in G-code and RAPID.")]
Simulate = Annotated[
    bool, typer.Option("--simulate", help="Mill under force control in the simulated cell, for its durations.")
]
Page = Annotated[Path | None, written_file("FILE.html", "Write paths, times and types.", "--report")]


def plan(
    pocket_file: PocketFile,
    path_file: PathFile = None,
    check_path: Check = False,
    planner_name: Name = "exact",
    pockets: Count = 1,
    untrained_planner: Untrained = False,
    learn: Learn = None,
    prior: PriorFile = None,
    record: Record = None,
    seed: Seed = 0,
    out: Out = None,
    gcode_file: GCode = None,
    rapid_file: Rapid = None,
    cell: Cell = Cutting.cell,
    depth: Depth = Cutting.depth,
    page: Page = None,
    simulate: Simulate = False,
    config: ConfigOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Plan the order in which a pocket is milled, or check a path: status 1 where it is illegal or leaves material.

    Example: `stagectl plan POCKET.json --planner uncertain --pockets 3 --out PATH.json --report plan.html`
    """
    if check_path != (path_file is not None):
        raise ValueError("--check goes with two files, POCKET.json PATH.json, and two files with --check")
    pocket, cutting = read_pocket(pocket_file), Cutting(cell, depth)
    if path_file is not None:
        _check(pocket, path_file, json)
        return
    made = _trained(planner_name, pocket, untrained_planner, seed, prior)
    for segment in read_segments(learn, pocket) if learn is not None else ():
        made.learn(segment)
    done = _milled(pocket, made, pockets, rig_file.load(config, CellConfig, settings or []) if simulate else None)
    if record is not None:
        write_segments(record, done)
    if out is not None:
        write_path(out, [each.in_path for each in done[-1]])
    for file, written in ((gcode_file, gcode), (rapid_file, rapid)):
        if file is not None:
            atomic.write(file, written(done[-1], pocket, cutting))
    _tell(done, pocket, planner_name, page, json)


def _trained(name: str, pocket: Pocket, is_untrained: bool, seed: int, prior: Path | None) -> Planner:
    if not is_untrained:
        return planner(name, pocket, seed, prior)
    if prior is not None:
        raise ValueError(f"--untrained has no prior of the rates, must be left out with --prior {prior}")
    return untrained(name, pocket)


def _milled(pocket: Pocket, made: Planner, pockets: int, cell: CellConfig | None) -> list[list[Milled]]:
    """Mill pockets at what is really paid, or in the simulated cell where there is a file of it."""
    if cell is None:
        return [mill(pocket, made) for _ in range(pockets)]
    with stoppable() as stop, progress("cells milled", pocket.rows * pocket.cols * pockets) as meter:
        meter.say("cells milled: in the simulated cell, where a pocket of 30 x 30 takes some fifteen seconds")
        try:
            return simulated_pockets(cell, pocket, made, pockets, Conduct(lambda: stop.made, show=meter.show))
        except ValueError:
            if stop.made:
                raise Stopped("stopped; nothing is stored") from None
            raise


def _check(pocket: Pocket, path_file: Path, json: str | None) -> None:
    verdict = check(pocket, read_path(path_file))
    optimum = least_time(pocket)
    found: dict[str, Any] = {
        "legal": verdict.error is None,
        "complete": verdict.complete,
        "error": verdict.error,
        "left": verdict.left,
        "total": verdict.total,
        "optimum": optimum,
        "gap": verdict.total / optimum - 1.0 if verdict.complete else None,
    }
    said = [verdict.error or "legal"]
    if not verdict.complete:
        said.append(f"leaves {verdict.left} of {pocket.rows * pocket.cols} cells")
    gap = f", {100 * found['gap']:.2f} % over the optimum, {optimum:.2f} s" if verdict.complete else ""
    print(f"{path_file}: {'; '.join(said)}: {verdict.total:.2f} s{gap}", file=words(json))  # noqa: T201
    write_json(json, found)
    if not verdict.complete:
        raise typer.Exit(1)


def _tell(done: list[list[Milled]], pocket: Pocket, name: str, page: Path | None, json: str | None) -> None:
    optimum, stream = least_time(pocket), words(json)
    known = learned_types((segment for each in done for segment in each), pocket)
    times = [total(each) for each in done]
    rows = [
        [f"{number}", f"{time:.2f}", f"{100 * (time / optimum - 1):.2f}", f"{len(each)}",
         " ".join(f"{'^' if segment.is_lifted else ''}{segment.name}" for segment in each)]
        for number, (time, each) in enumerate(zip(times, done, strict=True), start=1)
    ]  # fmt: skip
    head = ["pocket", "time, s", "over the optimum, %", "segments", "path; ^ is a lift"]
    print_table(f"{name}; the optimum is {optimum:.2f} s", head, rows, stream)
    print_table("milling types", list(TYPE_HEAD), type_rows(known), stream)
    if page is not None:
        write_report(page, done, pocket, name, optimum, known)
        print(f"report: {page}", file=stream)  # noqa: T201
    found = {
        "planner": name,
        "optimum": optimum,
        "pockets": [
            {"total": time, "gap": time / optimum - 1.0, "path": [segment.in_path for segment in each]}
            for time, each in zip(times, done, strict=True)
        ],
        "types": {
            each.name: {"segments": each.count, "mean": each.mean, "deviation": each.deviation} for each in known
        },
    }
    write_json(json, found)
