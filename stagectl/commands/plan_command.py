"""The command `stagectl plan`: pockets are planned one after the other, or a path is held against a pocket."""

from pathlib import Path
from typing import Annotated

import typer

from rigkit.command import ConfigOption, JsonOption, SetOption
from rigkit.common_options import one_of
from rigkit.written import written_file
from stagectl.planning.cutting import Cutting
from stagectl.planning.planner_names import PLANNERS, UNTRAINED

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
    from stagectl.commands import planned  # here and not above: its imports take a second, and --help needs none
    from stagectl.planning.pocket_file import read_pocket

    pocket, cutting = read_pocket(pocket_file), Cutting(cell, depth)
    if path_file is not None:
        planned.check_path(pocket, path_file, json)
        return
    made = planned.trained(planner_name, pocket, untrained_planner, seed, prior, learn)
    done = planned.milled(pocket, made, pockets, planned.cell_of(config, settings) if simulate else None)
    planned.write(done, pocket, cutting, planned.Written(record, out, gcode_file, rapid_file))
    planned.tell(done, pocket, planner_name, page, json)
