"""What docs/experiments.md states of each experiment is so: its tests are there, and so are options and procedures."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

from rigkit.code_name import resolve
from stagectl.application import PROGRAM
from stagectl.daemon.cell.procedures import SERVED
from stagectl.experiments import registry
from tests.commands.experiments_page import ABILITIES, NAMES, page, stated

ROOT = Path(__file__).parents[2]


def cells() -> Iterator[tuple[str, str, dict[str, Any]]]:
    known = stated()
    return ((each, ability, known[each][ability]) for each in NAMES for ability in ABILITIES)


@cache
def functions_of(path: Path) -> set[str]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


def options_of(name: str) -> set[str]:
    """Return the options of a command, `--live` and so on."""
    group = typer.main.get_group(PROGRAM.only(name))
    return {option for each in group.commands[name].params for option in each.opts}


def test_the_page_is_what_is_stated() -> None:
    assert (ROOT / "docs" / "experiments.md").read_text(encoding="utf-8") == page(), "make docs"


def test_every_cell_is_stated_and_nothing_else() -> None:
    assert {name: set(known) for name, known in stated().items()} == {name: set(ABILITIES) for name in NAMES}


@pytest.mark.parametrize("cell", [pytest.param(cell, id=f"{name}-{ability}") for name, ability, cell in cells()])
def test_each_cell_names_a_test_that_is_there_or_says_why_not(cell: dict[str, Any]) -> None:
    assert "why" in cell or cell.get("test") or "no test of its own" in cell["note"]
    if cell.get("test"):
        path, _, name = cell["test"].partition("::")
        assert name in functions_of(ROOT / path), f"no {cell['test']}"


@pytest.mark.parametrize("name", NAMES)
def test_options_are_as_stated(name: str) -> None:
    known, options = stated()[name], options_of(name)
    assert ("why" not in known["live"]) == ("--live" in options), f"[{name}] live of experiments.toml"
    keys = set(resolve(SERVED[name].options).model_fields) if name in SERVED else set()
    assert ("why" not in known["resume"]) == ("--resume" in options or "resume" in keys)


@pytest.mark.parametrize("name", [each.name for each in registry.CELL])
def test_procedures_are_as_stated(name: str) -> None:
    known = stated()[name]
    assert ("why" not in known["daemon"]) == (name in SERVED)
    assert ("why" not in known["pause"]) == (name in SERVED and bool(SERVED[name].on_pause))
