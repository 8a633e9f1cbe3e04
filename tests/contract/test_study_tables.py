"""The tables of docs/populations.md belong to the results that are kept beside them."""

from pathlib import Path

import pytest

from benchmarks import study_tables
from benchmarks.study_tables import KEPT, LARGEST, PAGE, page, take_in
from rigkit.stop import StopRequest
from rigkit.study import programs
from rigkit.study.engine import Study
from rigkit.study.folder import StudyFolder
from rigkit.study.plan import read_plan
from tests.contract.source_tree import ROOT
from tests.rigkit.study.small_study import Hands, Meter, outcome, plan_of


def test_the_page_is_the_one_that_its_results_give() -> None:
    """`python -m benchmarks.study_tables` writes it."""
    assert PAGE.read_text(encoding="utf-8") == page()


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
        texts.append(page())
    assert "| all | 4 | 0 | 0 | 0.25 | 0.25 |" in texts[0]
    assert "| all | 4 | 0 | 0 | 0.5 | 0.5 |" in texts[1]
    sums = [text.partition("SHA-256 ")[2] for text in texts]
    assert sums[0] != sums[1]
