"""What docs/experiments.md states of each experiment is so: its tests are there, and so are options and procedures."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer

from stagectl.application import PROGRAM
from stagectl.daemon.cell.procedures import PROCEDURES
from stagectl.experiments.kinds import KINDS
from tests.commands.experiments_page import ABILITIES, EXPERIMENTS, page, stated

ROOT = Path(__file__).parents[2]
OF_STAGE = {"run"}
"""A procedure of the stage's daemon, not of the cell's."""


def cells() -> Iterator[tuple[str, str, dict[str, Any]]]:
    known = stated()
    return ((each, ability, known[each][ability]) for each in EXPERIMENTS for ability in ABILITIES)


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
    assert {name: set(known) for name, known in stated().items()} == {name: set(ABILITIES) for name in EXPERIMENTS}


@pytest.mark.parametrize("cell", [pytest.param(cell, id=f"{name}-{ability}") for name, ability, cell in cells()])
def test_each_cell_names_a_test_that_is_there_or_says_why_not(cell: dict[str, Any]) -> None:
    assert "why" in cell or cell.get("test") or "no test of its own" in cell["note"]
    if cell.get("test"):
        path, _, name = cell["test"].partition("::")
        assert name in functions_of(ROOT / path)


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_options_are_as_stated(name: str) -> None:
    known, options = stated()[name], options_of(name)
    assert ("why" not in known["live"]) == ("--live" in options)
    keys = {key for each in PROCEDURES if each.name == name for key in each.options.model_fields}
    assert ("why" not in known["resume"]) == ("--resume" in options or "resume" in keys)


def test_procedures_are_as_stated() -> None:
    served = {each.name: bool(each.on_pause) for each in PROCEDURES}
    for name, known in stated().items():
        if name in OF_STAGE:
            continue
        assert ("why" not in known["daemon"]) == (name in served)
        assert ("why" not in known["pause"]) == served.get(name, False)


def test_every_kind_of_the_registry_has_a_row() -> None:
    assert len(KINDS) == 5, "midrange, step, cell, ilc, force: a new one wants a row"
