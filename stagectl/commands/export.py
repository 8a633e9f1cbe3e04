"""The recordings of a run of stage, cell or mid-ranging, in the formats of other programs."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import atomic
from rigkit.command import JsonOption, RunArgument, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.experiment.kept import recordings
from rigkit.export.mcap_file import write_mcap
from rigkit.export.optional import refuse_missing
from rigkit.export.parquet_file import write_recording
from rigkit.export.place import FileOption, OutOption, place_of
from rigkit.provenance import software
from rigkit.run_folder import CONFIG, EVENTS, SUMMARY, make_whole
from rigkit.run_origin import say_at_work
from rigkit.written import say_over
from stagectl.commands.changed import say_changed

FOLDER = "export"
"""Within the run folder, unless another place is named."""
FORMATS = ("mcap", "parquet")
BESIDE = (CONFIG, "stage.toml", EVENTS, SUMMARY)
"""Files of a run that go along whole where a format takes them."""


def export(
    path: RunArgument,
    formats: Annotated[
        list[str] | None,
        typer.Option(
            "--to",
            "--format",
            help="mcap or parquet; may be repeated; default: both.",
            autocompletion=one_of(FORMATS),
        ),
    ] = None,
    out: OutOption = None,
    file: FileOption = None,
    json: JsonOption = None,
) -> None:
    """Write the recordings of a run for other programs: MCAP for PlotJuggler and Foxglove, Parquet for data frames.

    Example: `stagectl export RUN/ --to mcap --file run.mcap`
    """
    say_changed(path)
    say_at_work(path)
    to = place_of(out, file, (".mcap",))
    place = path / FOLDER if to is None else to if to.is_dir() else to.parent
    there = set(place.iterdir()) if place.is_dir() else set()
    written = export_run(path, tuple(dict.fromkeys(formats or FORMATS)), to)
    say_over([each for each in written if each in there])
    rows = [[str(each), f"{each.stat().st_size / 1e6:.3g}"] for each in written]
    print_table(f"{path}: exported", ["file", "MB"], rows, words(json))
    write_json(json, {"files": [str(each) for each in written]})


def export_run(path: Path, formats: Sequence[str] = FORMATS, out: Path | None = None) -> list[Path]:
    """Write the recordings of a run folder in other formats; return the files.

    Parameters
    ----------
    path : Path
    formats : sequence of str
        Of `FORMATS`.
    out : Path, optional
        A folder, made if absent; or a file with the suffix .mcap, for that format alone.

    Raises
    ------
    ValueError : no such format or place, nothing is recorded, a damaged recording, a package that is not installed.
    """
    for name in formats:
        if name not in FORMATS:
            raise ValueError(f"--to is {name!r}, must be one of {', '.join(FORMATS)}")
    single = out is not None and out.suffix.lower() == ".mcap"
    if single and tuple(formats) != ("mcap",):
        raise ValueError(f"--out is {out}, must be a folder for --to {', '.join(formats)}")
    if not (path / CONFIG).is_file():
        raise ValueError(f"{path}/ is not the folder of a run: it has no {CONFIG}")
    make_whole(path)
    files = recordings(path)
    if not files:
        raise ValueError(f"{path}: nothing is recorded")
    refuse_missing(formats)
    with atomic.folder(path / FOLDER if out is None else out.parent if single else out) as folder:
        written = []
        if "mcap" in formats:
            written.append(out if single and out is not None else folder / "run.mcap")
            with atomic.replacing(written[-1]) as temporary:
                _write_mcap(temporary, path, files)
        for file in files if "parquet" in formats else ():
            written.append(folder / f"{file.stem}.parquet")
            with atomic.replacing(written[-1]) as temporary:
                write_recording(temporary, recording.read(file))
    return written


def _write_mcap(place: Path, path: Path, files: Sequence[Path]) -> None:
    def topics() -> Iterator[tuple[str, Recording]]:
        return ((f"/{file.stem}", recording.read(file)) for file in files)

    beside = [file for name in BESIDE if (file := path / name).is_file()]
    write_mcap(place, topics(), {"run": path.resolve().name, "exported_by": software()}, beside)
