"""STUDY.toml: which commands are run over which machines, seeds and settings, and which figures are taken."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import ValidationError

from rigkit.config import ConfigError, Section, setting
from rigkit.config_fault import explained, shown
from rigkit.study.json_path import steps
from rigkit.toml_text import key_text

NAME = r"^\w[\w.-]*$"
_PASSES = r"^(<=|>=|<|>) -?\d+(\.\d+)?([eE][+-]?\d+)?$"

Kind = Literal["number", "yes", "event", "text"]
Part = TypeVar("Part", bound=Section)


class Seeds(Section):
    """The seeds, taken in order; {seed} in the commands."""

    first: int = setting(1, "", "the first seed", ge=0, le=2**31)
    count: int = setting(1, "seeds", "how many, unless the budget ends the study before", "patience", ge=1, le=10**6)


class Budget(Section):
    """When a study ends: no new seed is begun after that."""

    cpu_hours: float = setting(0.0, "h", "processor time of all tasks; 0 for as long as it takes", "patience", ge=0)
    task_seconds: float = setting(3600.0, "s", "a task that takes longer is killed, and recorded so", gt=0, le=1e6)


class Settings(Section):
    """The settings of each machine and seed: every combination, a Latin hypercube, or a list of cases."""

    method: Literal["grid", "latin", "list"] = setting("grid", "", "how `values` or `cases` become cases")
    points: int = setting(10, "cases", "of a Latin hypercube", ge=1, le=100_000)
    seed: int = setting(1, "", "of a Latin hypercube", ge=0, le=2**31)
    values: dict[str, Any] = setting(
        {}, "", "by key: a list of values, or of a hypercube a table {low, high, log, whole} as well"
    )
    cases: tuple[dict[str, Any], ...] = setting((), "", "of method list: one table of keys and values for each case")


class StudyFile(Section):
    """A whole STUDY.toml."""

    name: str = setting("study", "", "names the study in its reports", pattern=NAME)
    purpose: str = setting("", "", "what it is to find out, for the report", "patience")
    commands: tuple[str, ...] = setting(
        (), "", "command lines of one task, run in order in a folder of its own until one fails; {seed}, {KEY}, "
        "{machine} and {settings} stand for values"
    )  # fmt: skip
    files: tuple[str, ...] = setting((), "", "files that each task finds in its folder", files=("",))
    keep: Literal["nothing", "failed", "all"] = setting("nothing", "", "whose folders stay", "patience")
    seeds: Seeds = Seeds()
    budget: Budget = Budget()
    machines: dict[str, Any] = setting(
        {}, "", "by name: a table of keys and values each, {machine} in the commands; `inputs` lists files and folders"
    )
    settings: Settings = Settings()
    figures: dict[str, Any] = setting({}, "", "by name: a table each, as of a figure")
    group: str = setting("", "", "name of a figure of kind text: each of its words is a row of the tables", "patience")


class Figure(Section):
    """One figure of a task, out of the JSON that its commands have written."""

    file: str = setting("", "", "name of the JSON file in the task's folder", pattern=r"^[^/]+$")
    path: str = setting("", "", "of the value: keys and indices as in shots[-1].iae[0] or axes[*].fit", min_length=1)
    title: str = setting("", "", "for tables; the figure's name where it is empty", "patience")
    unit: str = setting("", "", "for tables; 1 for a pure number", "patience")
    kind: Kind = setting("number", "", "an event is a count or a time, null where it never came")
    until: float = setting(0.0, "", "an event that had not come by then is censored there", ge=0)
    reduce: Literal["", "min", "max", "mean", "first", "last", "count"] = setting("", "", "many values to one")
    worst: Literal["highest", "lowest"] = setting("highest", "", "which end is bad", "patience")
    passes: str = setting("", "", "limit of a number that passes, such as '<= 3'; empty for none", "patience")
    timing: bool = setting(False, "", "a measured time: not part of the study's hash")


def refuse_wrong(study: StudyFile) -> None:
    """Refuse a study that is well formed, but not complete.

    Raises
    ------
    ConfigError : the text names key and value.
    """
    if not study.commands:
        raise ConfigError("commands is [], must hold at least one command line")
    names = [Path(file).name for file in study.files]
    if len(set(names)) != len(names):
        raise ConfigError(f"files is {shown(list(study.files))}, must have different names")
    for name, machine in study.machines.items():
        if not re.match(NAME, name) or not isinstance(machine, dict):
            raise ConfigError(f"machines.{key_text(name)} is {shown(machine)}, must be a table named by {NAME}")
    if not study.figures:
        raise ConfigError("figures is {}, must hold at least one figure")
    figures = figures_of(study)
    if study.group and (study.group not in figures or figures[study.group].kind != "text"):
        raise ConfigError(f"group is {shown(study.group)}, must be a figure of kind text")


def figures_of(study: StudyFile) -> dict[str, Figure]:
    """Return the figures by name.

    Raises
    ------
    ConfigError : one has a wrong key or value.
    """
    return {name: _figure(name, table) for name, table in study.figures.items()}


def part(model: type[Part], table: Any, where: str, whole: str) -> Part:
    """Read one table as a model; `where` is its key, `whole` what it is called in an error.

    Raises
    ------
    ConfigError : the text names key and value.
    """
    if not isinstance(table, Mapping):
        raise ConfigError(f"{where} is {shown(table)}, must be a table")
    try:
        return model.model_validate_json(json.dumps(table))
    except ValidationError as fault:
        if missing := [str(each["loc"][-1]) for each in fault.errors() if each["loc"][-1] not in table]:
            present = [name for name in missing if name in model.model_fields]
            if present:
                raise ConfigError(f"{where} has no {present[0]}, must have one") from None
        _, text = explained(fault, model, table, whole)
        raise ConfigError(f"{where}.{text}") from None


def _figure(name: str, table: Any) -> Figure:
    where = f"figures.{key_text(name)}"
    if not re.match(NAME, name):
        raise ConfigError(f"{where}: a name must match {NAME}")
    made = part(Figure, table, where, "a figure")
    try:
        steps(made.path)
    except ValueError as fault:
        raise ConfigError(f"{where}: {fault}") from None
    if made.kind == "event" and made.until <= 0:
        raise ConfigError(f"{where}.until is {made.until:g}, must be > 0 for an event")
    if made.passes and not re.match(_PASSES, made.passes):
        raise ConfigError(f"{where}.passes is {shown(made.passes)}, must be such as '<= 3' or '> 0.5'")
    if made.passes and made.kind not in ("number", "event"):
        raise ConfigError(f"{where}.passes is {shown(made.passes)}, but kind is {shown(made.kind)}")
    return made
