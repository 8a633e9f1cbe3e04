"""The tasks of a study, in order: each seed's machines, each machine's cases, each with its command lines."""

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rigkit.config import ConfigError, load
from rigkit.json_text import json_text
from rigkit.origin import checksum
from rigkit.study.command_line import Lines
from rigkit.study.design import Case, cases
from rigkit.study.file import Figure, StudyFile, figures_of, refuse_wrong
from rigkit.study.task import Task

INPUTS = "inputs"
"""The key of a machine's table that lists files and folders which its commands read."""
WITHOUT = "default"
"""The machine of a study that names none."""
_KEY_LENGTH = 16


def read_plan(path: Path, programs: Sequence[str], overrides: Sequence[str] = ()) -> "Plan":
    """Read a STUDY.toml and plan its tasks.

    Parameters
    ----------
    path : Path
    programs : sequence of str
        What commands may begin with.
    overrides : sequence of str, "table.key=value"

    Raises
    ------
    ConfigError : one line with the file, the key, the value and what is allowed.
    OSError : a file that the study names cannot be read.
    """
    study = load(path, StudyFile, overrides)
    try:
        return Plan(study, programs, path.parent)
    except ConfigError as fault:
        raise ConfigError(f"{path}: {fault}") from None


class Plan:
    """All tasks of a study.

    Parameters
    ----------
    study : StudyFile
    programs : collection of str
        What commands may begin with.
    folder : Path
        That relative inputs are relative to.

    Raises
    ------
    ConfigError : the study is not complete, or two of its tasks are the same.
    OSError : a file cannot be read.
    """

    def __init__(self, study: StudyFile, programs: Sequence[str], folder: Path) -> None:
        refuse_wrong(study)
        self.study = study
        self.figures: dict[str, Figure] = figures_of(study)
        self.files = {Path(file).name: Path(file) for file in study.files}
        self.sums = {name: checksum(file) for name, file in self.files.items()}
        """SHA-256 of each file, by name."""
        self.cases: list[Case] = cases(study.settings)
        self._inputs, self._machines = _machines(study, folder)
        self._lines = Lines(study.commands, programs)
        for machine in self._machines.values():
            self._lines.refuse_unused(machine, self.cases[0], study.seeds.count > 1)
        self._reading = {
            name: {"file": figure.file, "path": figure.path, "reduce": figure.reduce}
            for name, figure in self.figures.items()
        }
        self._refuse_same()

    @property
    def count(self) -> int:
        """How many tasks there are in all."""
        return self.study.seeds.count * self.per_seed

    @property
    def per_seed(self) -> int:
        """How many tasks there are of each seed."""
        return len(self._machines) * len(self.cases)

    def seeds(self) -> Iterator[tuple[Task, ...]]:
        """Yield the tasks of each seed, in order."""
        first, count = self.study.seeds.first, self.study.seeds.count
        for seed in range(first, first + count):
            yield tuple(self._of_seed(seed))

    def inputs_of(self, machine: str) -> str:
        """Return the hash of all files that a machine's tasks are given; empty where there are none."""
        given = {**self.sums, **self._inputs[machine]}
        return _hash(given) if given else ""

    def _of_seed(self, seed: int) -> Iterator[Task]:
        budget, keep = self.study.budget, self.study.keep
        for name, machine in self._machines.items():
            for case in self.cases:
                commands = self._lines.of(machine, case, name, seed)
                key = _hash([commands, self.sums, self._inputs[name]])
                yield Task(key, name, seed, case, commands, self._reading, budget.task_seconds, keep)

    def _refuse_same(self) -> None:
        tasks: dict[str, Task] = {}
        for task in self._of_seed(self.study.seeds.first):
            other = tasks.setdefault(task.key, task)
            if other is not task:
                raise ConfigError(
                    f"two tasks are the same: machine {other.machine}, {dict(other.case)} "
                    f"and machine {task.machine}, {dict(task.case)}"
                )


def _machines(study: StudyFile, folder: Path) -> tuple[dict[str, dict[str, str]], dict[str, dict[str, Any]]]:
    """Return the hashes of every machine's inputs, by path, and its values by key."""
    tables = study.machines or {WITHOUT: {}}
    sums: dict[str, dict[str, str]] = {}
    values: dict[str, dict[str, Any]] = {}
    for name, table in tables.items():
        listed = table.get(INPUTS, [])
        if not isinstance(listed, list) or not all(isinstance(each, str) and each for each in listed):
            raise ConfigError(f"machines.{name}.{INPUTS} is {listed!r}, must be a list of paths")
        paths = [folder.absolute() / each for each in listed]
        sums[name] = {str(number): _checksum(path) for number, path in enumerate(paths, start=1)}
        own = {key: value for key, value in table.items() if key != INPUTS}
        values[name] = own | {f"input.{number}": str(path) for number, path in enumerate(paths, start=1)}
    return sums, values


def _checksum(path: Path) -> str:
    """Return the hash of a file, or of all files of a folder but hidden ones, with their names."""
    if not path.is_dir():
        return checksum(path)
    files = sorted(each for each in path.rglob("*") if each.is_file() and not each.name.startswith("."))
    return _hash({str(file.relative_to(path)): checksum(file) for file in files})


def _hash(value: Any) -> str:
    return hashlib.sha256(json_text(value).encode()).hexdigest()[:_KEY_LENGTH]
