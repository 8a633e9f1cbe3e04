"""Statistics, tables and the page of a study."""

import math
from pathlib import Path

import numpy as np
import pytest

from rigkit.study.file import Figure
from rigkit.study.report import StudyReport
from rigkit.study.results import FOLDER, About, Row, write_rows
from rigkit.study.summary import groups, passes, share_of, statistics, survival, worst
from rigkit.study.tables import endings_table, figure_table, markdown

SHOT = Figure(file="r.json", path="shot", kind="event", until=10, title="shots")
WORST = Figure(file="r.json", path="db", unit="dB", passes="<= 0")
FIT = Figure(file="r.json", path="fit", worst="lowest")
YES = Figure(file="r.json", path="met", kind="yes")
WORD = Figure(file="r.json", path="why", kind="text")
FIGURES = {"shot": SHOT, "db": WORST, "fit": FIT, "met": YES, "why": WORD}


def row(seed: int, law: str, status: int = 0, **figures: float | str | None) -> Row:
    """Return a row; `figures` are None unless given."""
    commands = (f"draw --seed {seed}", f"learn --set law={law}", "judge")
    known = {name: figures.get(name) for name in FIGURES}
    told = "error: coil 2 is absent" if status else ""
    place = ("lab", "Processor X", "vibrostage 1", "feed")
    return Row(
        f"{seed}{law}", "shell", seed, {"law": law, "n": 3}, commands, status, 2 * (status > 0), told, known, 1,
        2.0, 36.0, f"2026-01-0{seed}", *place,
    )  # fmt: skip


ROWS = [
    row(1, "kalman", shot=3.0, db=-9.0, fit=0.9, met=1.0, why="met"),
    row(1, "thesis", shot=None, db=4.0, fit=0.5, met=0.0, why="too loud"),
    row(2, "kalman", shot=5.0, db=-2.0, fit=0.8, met=1.0, why="met"),
    row(2, "thesis", shot=12.0, db=1.0, fit=0.7, met=0.0, why="too loud"),
    row(3, "kalman", status=2),
    row(3, "thesis", shot=9.0, db=-1.0, fit=0.6, met=1.0, why="met"),
]


def test_groups_are_named_by_what_differs() -> None:
    assert [group.label for group in groups(ROWS)] == ["law=kalman", "law=thesis"]
    assert [group.label for group in groups(ROWS[:1])] == ["all"]


def test_words_of_a_figure_are_groups_of_their_own() -> None:
    found = groups(ROWS, "why")
    assert [(group.label, len(group.rows)) for group in found] == [
        ("-, law=kalman", 1),
        ("met, law=kalman", 2),
        ("met, law=thesis", 1),
        ("too loud, law=thesis", 2),
        ("law=kalman", 3),
        ("law=thesis", 3),
    ]


def test_machines_of_one_row_each_are_one_group() -> None:
    each = [Row(**{**row(0, law).__dict__, "machine": name}) for name in "abc" for law in ("x", "y")]
    assert [(group.label, len(group.rows)) for group in groups(each)] == [("law=x", 3), ("law=y", 3)]


def test_what_was_refused_counts_among_all_and_passes_nothing() -> None:
    kalman, thesis = groups(ROWS)
    found = statistics(kalman.rows, "db", WORST)
    assert (found.count, found.refused, found.failed, found.known) == (3, 1, 0, 2)
    assert found.share is not None
    assert (found.share.count, found.share.of) == (2, 3)
    assert (found.lowest, found.highest, found.quantiles[1]) == (-9.0, -2.0, -9.0)
    assert statistics(thesis.rows, "why", WORD).words == {"too loud": 2, "met": 1}


def test_an_event_that_came_too_late_never_or_not_at_all_is_censored() -> None:
    kalman, thesis = groups(ROWS)
    assert statistics(kalman.rows, "shot", SHOT).quantiles == (3.0, 5.0, math.inf)
    assert statistics(thesis.rows, "shot", SHOT).quantiles == (9.0, math.inf, math.inf)
    time, share, low, high = survival(thesis.rows, "shot", SHOT)
    np.testing.assert_array_equal(time, [0, 9, 10])
    np.testing.assert_allclose(share, [1, 2 / 3, 2 / 3])
    assert np.all(low < share + 1e-9)
    assert np.all(high > share - 1e-9)


def test_the_interval_is_wilsons() -> None:
    """Of 7 of 10: (0.397, 0.892), Wilson 1927, eq. of p. 209 with z = 1.96."""
    share, z = share_of(7, 10), 1.959964
    middle = (0.7 + z**2 / 20) / (1 + z**2 / 10)
    half = z * np.sqrt(0.7 * 0.3 / 10 + z**2 / 400) / (1 + z**2 / 10)
    np.testing.assert_allclose((share.low, share.high), (middle - half, middle + half), rtol=1e-6)
    assert share.interval == "40-89 %"


@pytest.mark.parametrize(
    ("limit", "value", "expected"),
    [("<= 0", 0.0, True), ("< 0", 0.0, False), (">= 2", 1.9, False), ("> -1e3", 0, True)],
)
def test_a_limit_is_met_or_not(limit: str, value: float, expected: bool) -> None:
    figure = Figure(file="a", path="b", passes=limit)
    assert passes(row(1, "a", db=value), "db", figure) is expected


def test_the_worst_come_first_and_what_never_came_before_all() -> None:
    assert [each.figures["shot"] for each in worst(ROWS, "shot", SHOT, 3)] == [None, 12.0, 9.0]
    assert [each.figures["db"] for each in worst(ROWS, "db", WORST, 2)] == [4.0, 1.0]
    assert [each.figures["fit"] for each in worst(ROWS, "fit", FIT, 2)] == [0.5, 0.6]


def test_a_table_says_how_many_and_how_sure() -> None:
    table = figure_table(groups(ROWS), "shot", SHOT)
    assert table.head[-2:] == ("by 10", "95 % interval")
    assert table.rows[1] == ("law=thesis", "3", "0", "0", "9", "never", "never", "9", "9", "1/3", "6-79 %")
    assert markdown(table).splitlines()[3].startswith("| law=thesis | 3 | 0 |")


def test_the_report_of_a_folder_and_of_a_file_are_the_same(tmp_path: Path) -> None:
    (tmp_path / FOLDER).mkdir()
    write_rows(tmp_path / FOLDER / "1.parquet", ROWS, About("laws", "Which law is better.", FIGURES, {}))
    found = StudyReport.of(tmp_path)
    assert found == StudyReport.of(tmp_path / FOLDER / "1.parquet")
    told = found.told()
    assert (told["tasks"], told["refused"], told["cpu_hours"]) == (6, 1, pytest.approx(0.06))
    assert told["figures"]["shot"]["worst"][0]["commands"][1] == "learn --set law=thesis"
    assert told["figures"]["db"]["groups"][0]["share"]["count"] == 2
    lines = "\n".join(found.lines())
    assert (
        "worst case of shots: never, shell-1, law=thesis, n=3\n  draw --seed 1 && learn --set law=thesis && judge"
        in lines
    )
    assert "status 2, 1 tasks: error: coil 2 is absent; the first is shell-3, law=kalman, n=3\n  draw" in lines


def test_the_page_has_a_picture_of_each_number_and_event(tmp_path: Path) -> None:
    write_rows(tmp_path / "1.parquet", ROWS, About("laws", "", FIGURES, {}))
    page = StudyReport.of(tmp_path).page()
    plots = {section.title: [plot.figure for plot in section.plots] for section in page.sections}
    assert [len(plots[name]) for name in ("shots", "db, dB", "fit", "met", "why")] == [1, 1, 1, 0, 0]
    (survived,) = plots["shots"]
    ends = [line.get_ydata()[-1] for line in survived.axes[0].lines]
    np.testing.assert_allclose(np.array(ends, float), [100 / 3, 200 / 3])
    assert "draw --seed 1 &amp;&amp; learn" in page.html()


def test_many_cases_are_drawn_over_their_settings(tmp_path: Path) -> None:
    rows = []
    for seed in range(1, 10):
        made = row(seed, f"{seed / 10}", shot=None if seed > 5 else float(seed), db=10.0**seed)
        rows.append(Row(**{**made.__dict__, "case": {"gain": seed / 10, "law": "kalman"}}))
    write_rows(tmp_path / "1.parquet", rows, About("laws", "", {"shot": SHOT, "db": WORST}, {}))
    first, second = (section.plots[0].figure for section in StudyReport.of(tmp_path).page().sections[:2])
    assert first.axes[0].get_xlabel() == "gain"
    assert max(first.axes[0].lines[0].get_ydata()) == 10
    assert second.axes[0].get_yscale() == "log"


def test_tasks_whose_last_lines_differ_in_numbers_alone_ended_alike() -> None:
    messages = [
        "error: 14 s are too short",
        "error: 1.6e+01 s are too short",
        "error: no such file",
        "error: -3 s are too short",
    ]
    rows = [Row(**{**row(seed, "thesis", status=2).__dict__, "message": text}) for seed, text in enumerate(messages)]
    told = [(line[0], line[2], line[3]) for line in endings_table(rows).rows]
    assert told == [
        ("error: 14 s are too short", "3", "shell-0, law=thesis, n=3"),
        ("error: no such file", "1", "shell-2, law=thesis, n=3"),
    ]
