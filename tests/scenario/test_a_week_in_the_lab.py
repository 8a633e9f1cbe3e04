"""What is refused, said, or the same after a week in the lab stands in docs/origin.md as it is."""

import pytest

from benchmarks.page_table import DOCS, replaced, table
from tests.scenario.lab_week import NAME, SITUATIONS, rows


@pytest.mark.slow
def test_each_cell_of_the_table_is_what_happens() -> None:
    page = (DOCS / "origin.md").read_text(encoding="utf-8")
    assert replaced(page, NAME, table(["command", *SITUATIONS], rows())) == page
