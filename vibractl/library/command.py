"""The commands `vibractl library ...`."""

import re
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import (
    ConfigOption,
    JsonOption,
    RunArgument,
    SetOption,
    application,
    laid_over,
    print_table,
    words,
    write_json,
)
from vibractl.config import RigConfig
from vibractl.library.entry import Entry, EntryError
from vibractl.library.folder import Candidate, Library, user_library
from vibractl.library.of_run import entry_of
from vibractl.library.tags import parsed
from vibractl.quality import PASS
from vibractl.reference_option import ReferenceOption
from vibractl.run_setup import refuse_changed
from vibractl.setup import reference_of

NEAREST = "nearest"

library_app = application("Stored drives by reference, rig and tags, to warm-start later runs.")

LibraryOption = Annotated[
    Path | None, typer.Option("--library", metavar="DIR", help="Folder of the library; default: this user's.")
]
TagOption = Annotated[
    list[str] | None,
    typer.Option("--tag", metavar="KEY=VALUE", help="A tag, such as depth=10; may be repeated."),
]
NameArgument = Annotated[str, typer.Argument(metavar="NAME", help="Name of an entry.")]


def library_at(path: Path | None) -> Library:
    """Return the library in a folder, or this user's."""
    return Library(path or user_library())


def chosen_entry(
    warm: str | None,
    config: RigConfig,
    tags: list[str] | None,
    path: Path | None,
    accept: Collection[str] = (),
) -> Entry | None:
    """Return the entry that `--warm` asks for; None without it.

    Raises
    ------
    ValueError : a tag of another form, no such entry, none that fits, or tags or a library without `--warm`.
    """
    if warm is None and (tags or path):
        raise ValueError("--tag and --library say which entry a run starts from; they go with --warm")
    if warm is None:
        return None
    library, asked, reference = library_at(path), parsed(tags or []), reference_of(config)
    if warm == NEAREST:
        return library.nearest(config, reference, asked, accept).entry
    return library.fitting(warm, config, reference, accept)


@library_app.command("add")
def add_command(
    run: RunArgument,
    name: Annotated[str | None, typer.Option(help="Name of the entry; default: run and shot.")] = None,
    tag: TagOption = None,
    accept: AcceptOption = None,
    shot: Annotated[
        int | None, typer.Option(help="Shot of the drive; default: the last that met the objective, or of least error.")
    ] = None,
    library: LibraryOption = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an entry of that name.")] = False,
    json: JsonOption = None,
) -> None:
    """Store the drive that a run has learned.

    Example: `vibractl library add RUN/ --name tank-10m --tag depth=10 --tag temperature=8`
    """
    tags, place = parsed(tag or []), library_at(library)
    if name is not None:
        place.file(name)  # refuses what is not a name before the run is read
    if name == NEAREST:
        raise EntryError(f"name {NEAREST!r} is what --warm calls the nearest; must be another")
    refuse_changed(run, accept or [])
    entry = entry_of(run, shot, tags)
    called = name or re.sub(r"[^A-Za-z0-9._-]+", "-", f"{run.resolve().name}-{entry.about['shot']}").lstrip("._-")
    file = place.write(called, entry, force)
    print_table(f"{file}: kept", _HEAD, [_row(called, entry)], words(json))
    write_json(json, {"file": str(file), **_figures(called, entry)})


@library_app.command("list")
def list_command(library: LibraryOption = None, json: JsonOption = None) -> None:
    """List all entries.

    Example: `vibractl library list --json -`
    """
    place, rows, figures = library_at(library), [], []
    for name in place.names:
        try:
            entry = place.read(name)
        except EntryError as fault:
            rows.append([name, "not readable", *[""] * (len(_HEAD) - 2)])
            figures.append({"name": name, "fault": str(fault)})
        else:
            rows.append(_row(name, entry))
            figures.append(_figures(name, entry))
    count = "1 entry" if len(rows) == 1 else f"{len(rows)} entries"
    print_table(f"{place.path}: {count}", _HEAD, rows, words(json))
    write_json(json, {"library": str(place.path), "entries": figures})


@library_app.command("show")
def show_command(name: NameArgument, library: LibraryOption = None, json: JsonOption = None) -> None:
    """Show everything that is stored in an entry.

    Example: `vibractl library show tank-10m`
    """
    place = library_at(library)
    figures = _figures(name, place.read(name))
    rows = [
        [key, ", ".join(f"{k}={v}" for k, v in text.items()) if isinstance(text, dict) else str(text)]
        for key, text in figures.items()
    ]
    print_table(str(place.file(name)), ["", "value"], rows, words(json))
    write_json(json, figures)


@library_app.command("remove")
def remove_command(name: NameArgument, library: LibraryOption = None, json: JsonOption = None) -> None:
    """Remove an entry.

    Example: `vibractl library remove tank-10m`
    """
    place = library_at(library)
    place.remove(name)
    words(json).write(f"{place.file(name)}: removed\n")
    write_json(json, {"removed": str(place.file(name))})


@library_app.command("nearest")
def nearest_command(
    config: ConfigOption = None,
    reference: ReferenceOption = None,
    tag: TagOption = None,
    library: LibraryOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """List the entries a run could start from, the nearest first, and why the others do not fit.

    Example: `vibractl library nearest --reference chirp:40:90:5 --tag depth=12`
    """
    made_with = rig_file.load(config, RigConfig, laid_over(settings, {"reference.signal": reference or None}))
    place = library_at(library)
    found, refused = place.ranked(made_with, reference_of(made_with), parsed(tag or []))
    rows = [[each.name, f"{each.distance:.3g}", *_row(each.name, each.entry)[1:]] for each in found]
    print_table(f"{place.path}: nearest first", ["entry", "distance", *_HEAD[1:]], rows, words(json))
    for name, reason in refused.items():
        words(json).write(f"{name} does not fit: {reason}\n")
    write_json(json, {"entries": [_candidate(each) for each in found], "refused": refused})


_HEAD = ["entry", "reference", "tags", "objective", "worst bin, dB", "error, dB", "date, UTC"]


def _row(name: str, entry: Entry) -> list[str]:
    about = entry.about
    tags = ", ".join(f"{key}={value}" for key, value in entry.tags.items())
    met = "met" if about["met"] == PASS else "not met"
    told = [about["reference_text"], tags, met, about["worst_line_db"], about["error_db"]]
    return [name, *told, about["date"][:16].replace("T", " ")]


def _figures(name: str, entry: Entry) -> dict[str, Any]:
    lines, outputs, inputs = entry.model.shape
    size = {"lines": lines, "accelerometers": outputs, "coils": inputs}
    return {**entry.about, "name": name, "tags": dict(entry.tags), **size}


def _candidate(each: Candidate) -> dict[str, Any]:
    return {**_figures(each.name, each.entry), "distance": each.distance}
