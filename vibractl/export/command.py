"""The command `vibractl export`."""

from typing import Annotated

import typer

from rigkit.command import JsonOption, RunArgument, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.export.place import FileOption, OutOption, place_of
from rigkit.run_folder import CONFIG
from rigkit.run_origin import say_at_work
from rigkit.written import say_over
from vibractl.export.run import FORMATS, SUFFIXES, export_run
from vibractl.run_setup import say_changed


def export_command(
    path: RunArgument,
    formats: Annotated[
        list[str] | None,
        typer.Option(
            "--format",
            "--to",
            help="uff, segy, csv, mat, mcap or parquet; may be repeated; default: all.",
            autocompletion=one_of(FORMATS),
        ),
    ] = None,
    out: OutOption = None,
    file: FileOption = None,
    shots: Annotated[str | None, typer.Option(help="all, or as in 0,5,10-20; default: first and last.")] = None,
    json: JsonOption = None,
) -> None:
    """Write model, reference and shots of a run for other programs: UFF58, SEG-Y, CSV, MATLAB, MCAP, Parquet.

    Example: `vibractl export RUN/ --format segy --shots all --file sweeps.sgy`
    """
    if (path / CONFIG).is_file():
        say_changed(path)
    say_at_work(path)
    place = place_of(out, file, [suffix for each in SUFFIXES.values() for suffix in each])
    done = export_run(path, tuple(dict.fromkeys(formats or FORMATS)), place, shots)
    say_over(done.over)
    rows = [[str(each), f"{each.stat().st_size / 1e6:.3g}"] for each in done.files]
    print_table(f"{path}: {len(done.shots)} of {done.recorded} shots exported", ["file", "MB"], rows, words(json))
    told = {"shots": list(done.shots), "recorded": done.recorded}
    write_json(json, {"files": [str(each) for each in done.files], **told})
