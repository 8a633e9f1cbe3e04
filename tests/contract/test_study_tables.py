"""The tables of docs/ that studies have given belong to the results that are kept in docs/populations/."""

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks import study_tables
from benchmarks.study_tables import KEPT, LARGEST, PAGE, pages, predicted_beside_observed, take_in
from rigkit.stop import StopRequest
from rigkit.study import programs
from rigkit.study.engine import Study
from rigkit.study.folder import StudyFolder
from rigkit.study.plan import read_plan
from tests.contract.source_tree import ROOT
from tests.rigkit.study.small_study import Hands, Meter, outcome, plan_of
from tests.rigkit.study.test_summary import row


def test_the_pages_are_those_that_the_results_give() -> None:
    """`python -m benchmarks.study_tables` writes them."""
    for page, text in pages().items():
        assert page.read_text(encoding="utf-8") == text, f"{page} is of other results"


def test_the_results_are_small_enough_to_be_kept() -> None:
    assert sum(file.stat().st_size for file in KEPT.glob("*.parquet")) < LARGEST


@pytest.mark.parametrize("file", sorted((ROOT / "studies").glob("*.toml")), ids=lambda file: file.stem)
def test_a_study_of_this_project_can_be_planned(file: Path) -> None:
    plan = read_plan(file, programs.names())
    assert plan.study.name == file.stem
    assert plan.study.budget.cpu_hours == 2.0


def test_another_result_gives_another_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study_tables, "KEPT", tmp_path / "kept")
    texts = []
    for value in (0.25, 0.5):
        with StudyFolder(tmp_path / f"{value}" / "pockets", plan_of(tmp_path)) as folder:
            Study(folder).run(Hands(lambda task, value=value: outcome(task, value=value)), Meter(), StopRequest())
        take_in(tmp_path / f"{value}" / "pockets")
        texts.append(pages()[PAGE])
    assert "| all | 4 | 0 | 0 | 0.25 | 0.25 |" in texts[0]
    assert "| all | 4 | 0 | 0 | 0.5 | 0.5 |" in texts[1]
    sums = [text.partition("SHA-256 ")[2] for text in texts]
    assert sums[0] != sums[1]


def test_a_prediction_beyond_the_run_is_right_where_nothing_was_observed_either() -> None:
    found = [(3.0, 4.0, 5.0, 8.0), (9.0, 11.0, None, 14.0), (20.0, None, None, None)]
    names = ("low", "predicted", "high", "observed")
    made = replace(row(1, "kalman"), case={"learning.law": "kalman"})
    rows = [replace(made, figures=dict(zip(names, shots, strict=True))) for shots in found]
    said = predicted_beside_observed([*rows, replace(made, status=1)])
    assert "within 3 shots of what was observed on 2 of 3" in said
    assert said.endswith("predicted on 2.")


def test_two_studies_have_their_tables_on_one_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study_tables, "KEPT", tmp_path / "kept")
    monkeypatch.setattr(study_tables, "DOCS", tmp_path)
    monkeypatch.setattr(study_tables, "PLACES", {"one": "page.md", "two": "page.md"})
    page = tmp_path / "page.md"
    page.write_text("".join(f"<!-- {name} -->\n<!-- end of {name} -->\n" for name in ("one", "two")))
    for name, value in (("one", 0.25), ("two", 0.5)):
        with StudyFolder(tmp_path / name, plan_of(tmp_path)) as folder:
            Study(folder).run(Hands(lambda task, value=value: outcome(task, value=value)), Meter(), StopRequest())
        take_in(tmp_path / name)
    for text in ("| 0.25 | 0.25 |", "| 0.5 | 0.5 |"):
        assert text in pages()[page]
