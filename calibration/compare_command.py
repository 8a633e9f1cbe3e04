"""`calibrate compare`."""

from pathlib import Path
from typing import Annotated

import typer

from calibration.comparison_report import comparison_figures, comparison_report
from calibration.model_comparison import (
    COMPARED_HEAD,
    DIFFERING_HEAD,
    compare,
    compare_far_fields,
    compared_rows,
    differing_rows,
)
from rigkit.command import JsonOption, print_table, words, write_json
from rigkit.written import made_folder, written_file
from vibractl.model_file import read_far_field, read_model


def compare_command(
    first: Annotated[Path, typer.Argument(metavar="A.h5")],
    second: Annotated[Path, typer.Argument(metavar="B.h5")],
    out: Annotated[Path | None, written_file("FILE", "Write a report (HTML).")] = None,
    png: Annotated[Path | None, made_folder("DIR", "Write the figures as PNG files.")] = None,
    json: JsonOption = None,
) -> None:
    """Compare two models of one rig, bin by bin, against their uncertainty.

    Example: `calibrate compare tank.h5 sea.h5 --out difference.html`
    """
    names = str(first), str(second)
    found = compare(read_model(first), read_model(second), *names)
    afar = read_far_field(first), read_far_field(second)
    far = None if afar[0] is None or afar[1] is None else compare_far_fields(afar[0], afar[1], *names)
    if out is not None or png is not None:
        report = comparison_report(found, far)
        if out is not None:
            report.write(out)
        if png is not None:
            report.png(png)
    stream = words(json)
    title = f"{found.first_name} and {found.second_name}: {len(found.frequency)} bins in common"
    print_table(title, COMPARED_HEAD, compared_rows(found), stream)
    print_table("farthest apart", DIFFERING_HEAD, differing_rows(found), stream)
    if far is not None:
        print_table("far field", COMPARED_HEAD, compared_rows(far), stream)
    write_json(json, comparison_figures(found, far))
