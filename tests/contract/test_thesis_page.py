"""The thesis' table belongs to its rows and the kept values, speaks of every figure, and its commands can be given."""

import json
import re
import shlex
from pathlib import Path

import pytest

from benchmarks.thesis import made
from benchmarks.thesis.__main__ import KEPT, PAGE
from benchmarks.thesis.groups import DONE, MADE, Group, groups, ordered, run
from benchmarks.thesis.page import page
from benchmarks.thesis.rows import Row, chapters, chosen, places
from tests.commands.dry_parse import parse

FIGURES = {2: 29, 3: 15, 4: 9, 5: 14, 6: 21, 7: 11, 8: 8}
"""By chapter, as the thesis numbers them."""
TABLES = {2: 3, 3: 1, 4: 1, 5: 1, 6: 0, 7: 2, 8: 0}
ROWS = [row for chapter in chapters() for row in chapter.rows]


def test_the_page_is_the_one_that_rows_and_kept_values_give() -> None:
    """`python -m benchmarks.thesis --write` writes it."""
    assert PAGE.read_text(encoding="utf-8") == page(chapters(), groups(), json.loads(KEPT.read_text(encoding="utf-8")))


@pytest.mark.parametrize("chapter", chapters(), ids=lambda each: f"chapter {each.number}")
def test_every_figure_and_table_of_a_chapter_is_spoken_of(chapter) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    wanted = {f"Fig. {chapter.number}.{n}" for n in range(1, FIGURES[chapter.number] + 1)}
    wanted |= {f"Tab. {chapter.number}.{n}" for n in range(1, TABLES[chapter.number] + 1)}
    assert {place for place in places(chapter) if not place.startswith("Sec.")} == wanted


def test_each_row_has_a_value_or_a_reason_and_no_two_are_alike() -> None:
    assert len({row.key for row in ROWS}) == len(ROWS)
    assert all(row.group in groups() or row.why for row in ROWS)
    assert set(json.loads(KEPT.read_text(encoding="utf-8"))["values"]) == {row.key for row in ROWS if row.group}


def test_what_ours_is_held_against_is_the_number_that_is_printed() -> None:
    """A limit ("within", "below", "over") is one as well."""
    said = [row for row in ROWS if row.value is not None and re.search(r"\d", row.printed)]
    for row in said:
        assert any(abs(float(text) - row.value) < 1e-9 for text in re.findall(r"\d+(?:\.\d+)?", row.printed)) or (
            row.key == "Fig. 8.6: Method 2 over Method 1"
        ), row.key
    assert len(said) > 60


@pytest.mark.parametrize("group", groups().values(), ids=lambda each: each.name)
def test_each_command_can_be_given(group: Group) -> None:
    for words in map(shlex.split, group.commands):
        if words[0] == MADE:
            assert words[1] in made.CASES
        else:
            parse(tuple(words))


def test_groups_come_after_those_whose_files_they_read() -> None:
    names = [group.name for group in ordered({"cuts", "tone"}, groups())]
    assert names == ["stage", "cuts", "vibrator", "tone"]


@pytest.mark.parametrize(
    ("better", "ours", "verdict"),
    [
        ("less", 9.0, "better"),
        ("less", 11.0, "worse"),
        ("more", 11.0, "better"),
        ("more", 10.1, "alike"),
        ("", 1.0, ""),
    ],
)
def test_a_value_is_better_worse_or_alike(better: str, ours: float, verdict: str) -> None:
    assert Row("Fig. 9.9", "error", "10", value=10.0, better=better).verdict(ours) == verdict


def test_what_never_came_is_worse() -> None:
    row = Row("Fig. 9.9", "shot", "30", group="run", value=30.0, better="less")
    assert row.verdict(None) == "worse"
    assert row.told(None) == "never"


def test_rows_are_chosen_by_figure_table_or_chapter() -> None:
    whole = chapters()
    assert {row.at for row in chosen(["5.7"], whole)} == {"Fig. 5.7"}
    assert {row.at for row in chosen(["Tab. 2.1"], whole)} == {"Tab. 2.1"}
    assert {row.at.split(" ")[1][0] for row in chosen(["3"], whole)} == {"3"}
    with pytest.raises(ValueError, match="no figure"):
        chosen(["9.1"], whole)


def test_a_group_that_was_stopped_goes_on_and_one_that_was_edited_begins_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []

    def counted(word: str) -> dict[str, str]:
        calls.append(word)
        if word == "stopped" and calls.count(word) == 1:
            raise KeyboardInterrupt
        return {"word": word}

    monkeypatch.setattr(made, "CASES", {"a": counted, "b": counted})
    group = Group("tried", ("made a whole", "made b stopped"))
    with pytest.raises(KeyboardInterrupt):
        run(group, tmp_path)
    assert run(group, tmp_path)["commands"] == list(group.commands)
    run(group, tmp_path)
    assert calls == ["whole", "stopped", "stopped"]
    assert json.loads((tmp_path / "tried" / "b.json").read_text()) == {"word": "stopped"}
    run(Group("tried", ("made b other",)), tmp_path)
    assert calls[3:] == ["other"]
    assert not (tmp_path / "tried" / "a.json").exists()
    assert (tmp_path / "tried" / DONE).exists()
