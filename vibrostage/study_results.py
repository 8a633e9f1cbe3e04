"""The commands `vibrostage study report` and `compare`."""

from pathlib import Path
from typing import Annotated

import typer

from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.study.comparison import difference, ends_differently, is_within, matched
from rigkit.study.report import PAGE, StudyReport
from rigkit.study.tables import case_name


def report_command(
    path: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study, or a file of its results.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The page; default: DIR/report.html, none for a file.")
    ] = None,
    png: Annotated[Path | None, typer.Option(metavar="DIR", help="Write the figures as PNG files as well.")] = None,
    json: JsonOption = None,
) -> None:
    """Report a study: distributions, survival curves, and the worst cases with the commands that repeat them.

    Example: `vibrostage study report LAWS/ --json laws.json`
    """
    found = StudyReport.of(path)
    stream = words(json)
    for text, table in found.tables():
        print_table(text, table.head, table.rows, stream)
    for line in found.lines():
        print(line, file=stream)  # noqa: T201
    target = path / PAGE if out is None and path.is_dir() else out
    if target is not None or png is not None:
        page = found.page()
        if target is not None:
            page.write(target)
            print(f"report: {target}", file=stream)  # noqa: T201
        if png is not None:
            page.png(png)
    write_json(json, found.told())


def compare_command(
    one: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study, or a file of its results.")],
    other: Annotated[
        Path, typer.Argument(metavar="OTHER", help="The same study, from elsewhere or by other software.")
    ],
    tolerance: Annotated[
        float, typer.Option(min=0.0, help="Relative to the larger value; 0 for identical bits.")
    ] = 0.0,
    json: JsonOption = None,
) -> None:
    """Compare two results of a study task by task; status 1 where a figure differs by more than the tolerance.

    Example: `vibrostage study compare LAWS/ ELSEWHERE/ --tolerance 1e-9`
    """
    first, second = StudyReport.of(one), StudyReport.of(other)
    pairs = matched(first.rows, second.rows)
    common = {name: figure for name, figure in first.about.figures.items() if name in second.about.figures}
    found = {name: difference(pairs, name, figure) for name, figure in common.items()}
    ends = ends_differently(pairs)
    rows = [
        [
            name,
            str(each.count),
            str(each.differing),
            f"{each.largest:.3g}",
            case_name(each.worst) if each.worst else "-",
        ]
        for name, each in found.items()
    ]
    head = ["figure", "tasks", "other bits", "largest difference, of the value", "in"]
    print_table(f"{one} and {other}: {len(pairs)} tasks, {len(ends)} end otherwise", head, rows, words(json))
    is_same = not ends and is_within(found, common, tolerance)
    figures = {name: {"differing": each.differing, "largest": each.largest} for name, each in found.items()}
    write_json(json, {"tasks": len(pairs), "ends": len(ends), "within": is_same, "figures": figures})
    if not is_same:
        raise typer.Exit(1)
