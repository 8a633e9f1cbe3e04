"""The reference page of a rig file: every key has its row, with unit, range and default."""

from collections.abc import Iterator

import pytest
from pydantic import BaseModel, Field

from rigkit.config import Section, setting
from rigkit.config_reference import reference
from stagectl.config import StageConfig
from stagectl.robot.config import CellConfig
from tests.rigkit.rig_file import RigFile
from vibractl.config import RigConfig


class Pipe(Section):
    """What comes through."""

    gate: str = setting("a|b", "", "one | the other", pattern="a|b")


class Piped(Section):
    """A file with a table."""

    pipe: Pipe = Field(default_factory=Pipe)


def keys(values: BaseModel, path: str = "") -> Iterator[tuple[str, str]]:
    for name, value in values:
        if isinstance(value, BaseModel):
            yield from keys(value, f"{path}.{name}" if path else name)
        else:
            yield path, name


def rows(page: str) -> dict[tuple[str, str], list[str]]:
    found, table = {}, ""
    for line in page.splitlines():
        if line.startswith("## "):
            table = line.strip("#` []")
        elif line.startswith("| `"):
            cells = [cell.strip() for cell in line.strip("|").split(" | ")]
            found[table, cells[0].strip("`")] = cells[1:]
    return found


@pytest.mark.parametrize("model", [RigConfig, StageConfig, CellConfig])
def test_every_key_has_a_row_that_says_what_it_is(model: type[Section]) -> None:
    found = rows(reference(model, "x.toml"))
    assert list(found) == list(keys(model()))
    assert all(meaning and allowed and default for meaning, _, allowed, default in found.values())


def test_a_row_says_meaning_unit_range_and_default() -> None:
    found = rows(reference(RigFile, "rig.toml"))
    assert found["device", "rate"] == ["sample rate", "samples/s", "a whole number >= 8000 and <= 192000", "`44100`"]
    assert rows(reference(CellConfig, "cell.toml"))["feedback", "corner"][1:] == [
        "Hz", "a list of 3 numbers > 0 and <= 200", "`[1.5, 1.5, 1.5]`"
    ]  # fmt: skip


def test_a_bar_does_not_end_a_cell() -> None:
    assert r'| `gate` | one \| the other |  | text, matching `a\|b` | `"a\|b"` |' in reference(Piped, "x.toml")
