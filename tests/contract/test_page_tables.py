"""Tables that benchmarks write have their place in the documentation."""

import ast

import pytest

from benchmarks.page_table import DOCS, replaced, table
from tests.contract.source_tree import sources, tree


def places() -> list[tuple[str, str]]:
    """Find the page and name in every call of `put`."""
    calls = (
        node
        for file in sources("benchmarks")
        for node in ast.walk(tree(file))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "put"
    )
    return [tuple(ast.literal_eval(argument) for argument in call.args[1:]) for call in calls]


def test_there_are_tables() -> None:
    assert len(places()) >= 5


@pytest.mark.parametrize(("page", "name"), places())
def test_a_written_table_has_its_place_in_its_page(page: str, name: str) -> None:
    assert "| 1 |" in replaced((DOCS / page).read_text(encoding="utf-8"), name, "| 1 |")


def test_only_what_stands_between_the_marks_is_replaced() -> None:
    page = "a\n<!-- x -->\nold\n<!-- end of x -->\nb\n"
    assert replaced(page, "x", table(["n"], [[1]])) == "a\n<!-- x -->\n| n |\n| --- |\n| 1 |\n<!-- end of x -->\nb\n"


def test_a_page_without_the_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="once each"):
        replaced("text", "x", "| 1 |")
