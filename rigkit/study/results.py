"""The results of a study: rows of Parquet, one whole file a batch, and the hash that says whether two are the same."""

import hashlib
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from rigkit import atomic
from rigkit.config import ConfigError
from rigkit.export.optional import optional
from rigkit.export.parquet_file import ABOUT, Column, write_table
from rigkit.json_text import json_text
from rigkit.study.command_line import shell_line
from rigkit.study.file import Figure, part
from rigkit.study.outcome import Outcome
from rigkit.study.task import Task

FOLDER = "results"
PREFIX = "figure."
"""Begins the name of a figure's column."""
_TEXTS = ("key", "machine", "case", "commands", "message", "finished", "host", "processor", "software", "inputs")
_NUMBERS = {"seed": "", "status": "", "failed": "", "tries": "", "wall": "s", "cpu": "s"}
_SCHEMA = 1


@dataclass(frozen=True)
class Row:
    """One task and what came of it; the fields are those of `Task` and `Outcome`.

    `figures` holds None for what there is none of, `case` the settings by key, `commands` lines for a shell; `inputs`
    is the hash of all files that the task was given.
    """

    key: str
    machine: str
    seed: int
    case: Mapping[str, Any]
    commands: tuple[str, ...]
    status: int
    failed: int
    message: str
    figures: Mapping[str, float | str | None]
    tries: int
    wall: float
    cpu: float
    finished: str
    host: str
    processor: str
    software: str
    inputs: str

    @classmethod
    def of(cls, task: Task, outcome: Outcome, kinds: Mapping[str, Figure], inputs: str) -> Self:
        """Return the row of a task."""
        return cls(
            task.key, task.machine, task.seed, dict(task.case),
            tuple(shell_line(words) for words in (*outcome.given, *task.commands[len(outcome.given) :])),
            outcome.status, outcome.failed, outcome.message,
            {name: _plain(outcome.figures[name], figure) for name, figure in kinds.items()},
            outcome.tries, outcome.wall, outcome.cpu, outcome.finished,
            outcome.host, outcome.processor, outcome.software, inputs,
        )  # fmt: skip


@dataclass(frozen=True)
class About:
    """What the rows of a file are of.

    Parameters
    ----------
    name, purpose : str
        Of the study.
    figures : mapping of str to Figure
    files : mapping of str to str
        SHA-256 of each file that every task finds in its folder, by name.
    group : str
        The figure whose words are groups of their own; empty for none.
    """

    name: str
    purpose: str
    figures: Mapping[str, Figure]
    files: Mapping[str, str]
    group: str = ""

    @property
    def told(self) -> dict[str, Any]:
        """It as JSON takes it."""
        figures = {name: figure.model_dump() for name, figure in self.figures.items()}
        told = {"schema": _SCHEMA, "study": self.name, "purpose": self.purpose, "group": self.group}
        return {**told, "figures": figures, "files": dict(self.files)}

    @classmethod
    def of(cls, told: Mapping[str, Any], where: str) -> Self:
        """Return what a file tells; ValueError where it is no study's."""
        if told.get("schema") != _SCHEMA or not isinstance(told.get("figures"), dict):
            raise ValueError(f"{where}: these are no results of a study, or of another schema than {_SCHEMA}")
        try:
            figures = {name: part(Figure, table, name, "a figure") for name, table in told["figures"].items()}
        except ConfigError as fault:
            raise ValueError(f"{where}: {fault}") from None
        texts = (str(told.get(name, "")) for name in ("study", "purpose", "group"))
        name, purpose, group = texts
        return cls(name, purpose, figures, dict(told.get("files", {})), group if group in figures else "")


def write_rows(path: Path, rows: Sequence[Row], about: About) -> None:
    """Write rows to a file, whole or not at all."""
    columns = [Column(name, "", np.array([_text(getattr(row, name)) for row in rows])) for name in _TEXTS]
    columns += [Column(name, unit, np.array([getattr(row, name) for row in rows])) for name, unit in _NUMBERS.items()]
    for name, figure in about.figures.items():
        absent: Any = "" if figure.kind == "text" else math.nan
        values = [absent if row.figures[name] is None else row.figures[name] for row in rows]
        columns.append(Column(f"{PREFIX}{name}", figure.unit, np.array(values)))
    with atomic.replacing(path) as temporary:
        write_table(temporary, columns, about.told)


def read_rows(path: Path) -> tuple[About, list[Row]]:
    """Read the rows of a file, or of all in a folder, each task once, in the order of seeds.

    Raises
    ------
    ValueError : there are none, or a file holds no results of a study, or of another one than the others.
    """
    files = sorted(each for each in path.glob("*.parquet") if not atomic.is_leftover(each)) if path.is_dir() else [path]
    if not files:
        raise ValueError(f"{path}/ holds no results: there is no *.parquet")
    found: dict[str, Row] = {}
    about: About | None = None
    for file in files:
        told, rows = _read(file)
        if about is not None and (told.name, told.figures) != (about.name, about.figures):
            raise ValueError(f"{file}: is of another study than {files[0].name}")
        about = told
        found |= {row.key: row for row in rows}
    assert about is not None
    return about, sorted(found.values(), key=lambda row: (row.seed, row.machine, json_text(row.case), row.key))


def compact(folder: Path, about: About) -> None:
    """Make one file of all in a folder; a kill meanwhile leaves rows twice, and `read_rows` takes each once."""
    files = sorted(folder.glob("*.parquet"))
    if len(files) > 1:
        _, rows = read_rows(folder)
        whole = next_file(folder)
        write_rows(whole, rows, about)
        for file in files:
            with suppress(FileNotFoundError):
                file.unlink()


def next_file(folder: Path) -> Path:
    """Return the name of the next batch."""
    numbers = [int(file.stem) for file in folder.glob("*.parquet") if file.stem.isdigit()]
    return folder / f"{max(numbers, default=0) + 1:06d}.parquet"


def study_hash(rows: Iterable[Row], figures: Mapping[str, Figure]) -> str:
    """Return the SHA-256 of what came of all tasks, whatever the order; no times, places and versions are in it."""
    lasting = [name for name, figure in figures.items() if not figure.timing]
    whole = hashlib.sha256()
    for row in sorted(rows, key=lambda row: row.key):
        own = {name: row.figures[name] for name in sorted(lasting)}
        whole.update(f"{json_text([row.key, row.status, row.failed, row.message, own])}\n".encode())
    return whole.hexdigest()


def _read(file: Path) -> tuple[About, list[Row]]:
    arrow, parquet = optional("pyarrow"), optional("pyarrow.parquet")
    try:
        with file.open("rb") as stream:  # whose errors name the file
            # without `read_table`, whose scanner has threads that can abort a program that ends
            table = parquet.ParquetFile(stream, pre_buffer=False).read(use_threads=False)
    except (arrow.ArrowException, OSError) as fault:
        if isinstance(fault, OSError) and fault.errno is not None:
            raise
        raise ValueError(f"{file}: cannot be read as Parquet: {fault}") from None
    metadata = table.schema.metadata or {}
    about = About.of(json.loads(metadata.get(ABOUT.encode(), b"{}")), str(file))
    missing = {*_TEXTS, *_NUMBERS, *(f"{PREFIX}{name}" for name in about.figures)} - set(table.column_names)
    if missing:
        raise ValueError(f"{file}: there is no column {sorted(missing)[0]}")
    return about, list(_rows(table.to_pylist(), about))


def _rows(columns: Iterable[Mapping[str, Any]], about: About) -> Iterator[Row]:
    for told in columns:
        own = {name: told[name] for name in (*_TEXTS, *_NUMBERS)}
        own["case"], own["commands"] = json.loads(own["case"]), tuple(json.loads(own["commands"]))
        figures = {name: _absent(told[f"{PREFIX}{name}"]) for name in about.figures}
        yield Row(**own, figures=figures)


def _absent(value: Any) -> Any:
    return None if value == "" or (isinstance(value, float) and math.isnan(value)) else value


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json_text(value)


def _plain(value: Any, figure: Figure) -> float | str | None:
    """Return a figure as its column has it."""
    if value is None or isinstance(value, str) == (figure.kind != "text"):
        return None
    return str(value) if figure.kind == "text" else float(value)
