"""The command `stagectl plan`: a pocket is planned, or a path is held against it."""

from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit.command import JsonOption, print_table, words, write_json
from stagectl.planning.exact import least_time
from stagectl.planning.milling import Milled, mill, total
from stagectl.planning.pocket import PLANNERS, Pocket, check, planner
from stagectl.planning.pocket_file import read_path, read_pocket, write_path


def plan(
    pocket_file: Annotated[Path, typer.Argument(metavar="POCKET.json", help="The pocket, its tool and its costs.")],
    path_file: Annotated[
        Path | None, typer.Argument(metavar="PATH.json", help="With --check: the path to look at.")
    ] = None,
    check_path: Annotated[bool, typer.Option("--check", help="Say whether PATH.json mills the pocket.")] = False,
    planner_name: Annotated[str, typer.Option("--planner", metavar="NAME", help=f"{', '.join(PLANNERS)}.")] = "exact",
    seed: Annotated[int, typer.Option(min=0, help="Of what the planner draws.")] = 0,
    out: Annotated[Path | None, typer.Option(metavar="PATH.json", help="Write the path.")] = None,
    json: JsonOption = None,
) -> None:
    """Plan the order in which a pocket is milled, or check a path: status 1 where it is illegal or leaves material.

    Example: `stagectl plan POCKET.json --planner exact --out PATH.json`
    """
    if check_path != (path_file is not None):
        raise ValueError("--check goes with two files, POCKET.json PATH.json, and two files with --check")
    pocket = read_pocket(pocket_file)
    if path_file is not None:
        _check(pocket, path_file, json)
        return
    made = planner(planner_name, pocket, seed)
    segments = mill(pocket, made)
    if out is not None:
        write_path(out, [each.in_path for each in segments])
    _tell(segments, pocket, planner_name, json)


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


def _tell(segments: list[Milled], pocket: Pocket, name: str, json: str | None) -> None:
    rows = [
        [f"{number}", each.name, f"{each.row}", f"{each.col}", "lift" if each.is_lifted else "", f"{each.moved:.3f}",
         f"{each.duration:.3f}"]
        for number, each in enumerate(segments, start=1)
    ]  # fmt: skip
    head = ["segment", "type", "row", "col", "to it", "move, s", "milling, s"]
    spent, optimum = total(segments), least_time(pocket)
    print_table(f"{name}: {spent:.2f} s, {100 * (spent / optimum - 1):.2f} % over the optimum", head, rows, words(json))
    write_json(
        json,
        {
            "planner": name,
            "total": spent,
            "optimum": optimum,
            "gap": spent / optimum - 1.0,
            "path": [each.in_path for each in segments],
        },
    )
