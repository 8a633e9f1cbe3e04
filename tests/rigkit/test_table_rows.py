"""Rows read at once are those that are read cell by cell, whatever is in the file."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from ctlblocks.recording import RecordingError
from rigkit import number_rows, table_rows
from rigkit.table_rows import Cells, parsed

KINDS = {
    "commas": Cells(",", 3),
    "semicolons": Cells(";", 3),
    "decimal comma": Cells(";", 3, ","),
    "tabs": Cells("\t", 3),
    "spaces": Cells(None, 3),
}
LETTERS = st.sampled_from('0123456789+-.eE,; \n\tnaifxNA"_#%\ufeff')


def clean(cells: Cells) -> str:
    """Return three rows without a fault."""
    rows = [("1", "-2.5e-3", "0.1"), ("7", "8", "1e300"), ("0.30000000000000004", "4.9e-324", "12345678901234567890")]
    between = cells.between or " "
    return "".join(between.join(cell.replace(".", cells.decimal) for cell in row) + "\n" for row in rows)


def told(text: str, cells: Cells, column: int | None = None) -> tuple[list[int], list[list[float]]] | str:
    """Return places and values, or the error."""
    try:
        places, values = parsed(Path("x.csv"), 5, text.encode(), cells, column)
    except RecordingError as fault:
        return str(fault)
    return places.tolist(), values.tolist()


@pytest.fixture(params=["with Arrow", "without"])
def parser(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(number_rows, "_has_arrow", lambda: request.param == "with Arrow")


@pytest.mark.sample(4)
@pytest.mark.usefixtures("parser")
@pytest.mark.parametrize("kind", KINDS)
@given(edits=st.lists(st.tuples(st.integers(0, 80), LETTERS), max_size=4))
@example(edits=[(0, "\ufeff")])
@example(edits=[(0, " ")])
@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])  # the same for all
def test_reading_at_once_changes_nothing(kind: str, edits: list[tuple[int, str]]) -> None:
    cells = KINDS[kind]
    text = clean(cells)
    for place, letter in edits:
        text = text[:place] + letter + text[place + 1 :]
    found = told(text, cells)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(table_rows, "number_rows", lambda *_: None)
        assert found == told(text, cells)


@pytest.mark.usefixtures("parser")
@pytest.mark.parametrize("kind", KINDS)
def test_clean_rows_are_read_at_once(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_rows, "_kept", lambda *_: pytest.fail("cell by cell"))
    cells = KINDS[kind]
    rows = [[1.0, -2.5e-3, 0.1], [7.0, 8.0, 1e300], [0.1 + 0.2, 5e-324, 12345678901234567890.0]]
    assert told(clean(cells), cells) == ([5, 6, 7], rows)
    assert told(clean(cells), cells, 1) == ([5, 6, 7], [[row[1]] for row in rows])
