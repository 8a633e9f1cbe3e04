"""The order of a study, its budget, its end, and how it goes on."""

from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from rigkit.agreement import DisagreementError
from rigkit.lock import FolderInUseError
from rigkit.stop import StopRequest
from rigkit.study import engine
from rigkit.study.engine import Study
from rigkit.study.folder import StudyFolder
from rigkit.study.outcome import Outcome
from rigkit.study.plan import Plan
from rigkit.study.results import study_hash
from rigkit.study.task import Task
from tests.rigkit.study.small_study import STUDY, Hands, Meter, outcome, plan_of

HOUR = 3600.0
TWO = (STUDY % 5).replace('["sequential"]', '["sequential", "uncertain"]')


def run(out: Path, plan: Plan, hands: Hands, meter: Meter | None = None) -> tuple[Study, str]:
    """Run a study to its end, and return it with its hash."""
    with StudyFolder(out, plan) as folder:
        study = Study(folder)
        study.run(hands, meter or Meter(), StopRequest())
        return study, study_hash(folder.rows(), plan.figures)


def test_seeds_are_taken_in_order_until_the_budget_is_spent_and_a_begun_one_is_ended(tmp_path: Path) -> None:
    plan = plan_of(tmp_path, TWO + "\n[budget]\ncpu_hours = 5.0\n")
    hands, meter = Hands(lambda task: outcome(task, 2.0 * HOUR)), Meter()
    study, _ = run(tmp_path / "out", plan, hands, meter)
    assert [task.seed for task in hands.seen] == [1, 1, 2, 2]
    assert study.tally.cpu == 8.0
    assert meter.shown == [2 / 5, 4 / 5, 6 / 5, 8 / 5]


def test_it_goes_on_where_the_budget_has_grown(tmp_path: Path) -> None:
    hands = Hands(lambda task: outcome(task, HOUR))
    for hours, seeds in ((2.0, [1, 1]), (2.0, []), (4.0, [2, 2]), (0.0, [3, 3, 4, 4, 5, 5])):
        hands.seen.clear()
        run(tmp_path / "out", plan_of(tmp_path, TWO + f"\n[budget]\ncpu_hours = {hours}\n"), hands)
        assert [task.seed for task in hands.seen] == seeds
    assert len(list((tmp_path / "out" / "results").iterdir())) == 1


def test_a_stop_costs_what_is_under_way_and_the_end_is_the_same(tmp_path: Path) -> None:
    plan, stop = plan_of(tmp_path), StopRequest()

    def second(task: Task) -> Outcome:
        stop.made = task.seed == 2
        return outcome(task, value=float(task.seed))

    with StudyFolder(tmp_path / "out", plan) as folder:
        Study(folder).run(Hands(second), Meter(), stop)
        assert [row.seed for row in folder.rows()] == [1, 2]
    hands = Hands(lambda task: outcome(task, value=float(task.seed)))
    _, went_on = run(tmp_path / "out", plan, hands)
    assert [task.seed for task in hands.seen] == [3, 4]
    _, at_once = run(tmp_path / "other", plan, hands)
    assert went_on == at_once


def test_a_task_whose_worker_died_is_given_to_another(tmp_path: Path) -> None:
    died = []

    def dies(task: Task) -> Outcome:
        if task.seed == 3 and len(died) < 2:
            died.append(task)
            raise EOFError
        return outcome(task)

    hands = Hands(dies, slots=2, lost=(EOFError,))
    study, _ = run(tmp_path / "out", plan_of(tmp_path), hands)
    assert (study.tally.done, len(died), len(hands.seen)) == (4, 2, 6)


def test_what_is_done_is_on_the_disk_when_a_worker_fails_for_good(tmp_path: Path) -> None:
    def gone(task: Task) -> Outcome:
        if task.seed == 3:
            future: Future[Any] = Future()
            future.cancel()
            future.result()
        return outcome(task)

    plan = plan_of(tmp_path)
    with pytest.raises(ValueError, match=r"3-default-\w+: the workers are gone"):
        run(tmp_path / "out", plan, Hands(gone))
    with StudyFolder(tmp_path / "out", plan) as folder:
        assert [row.seed for row in folder.rows()] == [1, 2]


def test_a_batch_is_written_now_and_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "BATCH_SECONDS", -1.0)
    out, seen = tmp_path / "out", []

    def look(task: Task) -> Outcome:
        seen.append(len(list((out / "results").iterdir())))
        return outcome(task)

    run(out, plan_of(tmp_path), Hands(look))
    assert seen == [0, 1, 2, 3]


def test_why_a_figure_is_missing_is_said_once(tmp_path: Path) -> None:
    meter = Meter()

    def lacks(task: Task) -> Outcome:
        made = outcome(task)
        return Outcome(**{**made.__dict__, "notes": ("figure gap: it has no gap",)})

    run(tmp_path / "out", plan_of(tmp_path), Hands(lacks), meter)
    assert len(meter.said) == 1
    assert meter.said[0].endswith("figure gap: it has no gap")


def test_workers_of_another_version_are_refused(tmp_path: Path) -> None:
    def old(task: Task) -> Outcome:
        return Outcome(**{**outcome(task).__dict__, "software": "vibrostage 0.0.1", "host": "lab-7"})

    with pytest.raises(ValueError, match=r"lab-7: its worker is vibrostage 0\.0\.1, must be vibrostage"):
        run(tmp_path / "out", plan_of(tmp_path), Hands(old))


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("--pockets 2", "--pockets 3", "commands"),
        ("task_seconds = 3.0", "task_seconds = 4.0", "budget.task_seconds"),
        ('["sequential"]', '["uncertain"]', "settings.values.planner"),
    ],
)
def test_the_folder_of_another_study_is_refused(tmp_path: Path, old: str, new: str, key: str) -> None:
    text = STUDY % 2 + "[budget]\ntask_seconds = 3.0\n"
    run(tmp_path / "out", plan_of(tmp_path, text), Hands(outcome))
    with pytest.raises(DisagreementError, match=rf"out/ is of another study: {key} was .*; give another --out"):
        run(tmp_path / "out", plan_of(tmp_path, text.replace(old, new)), Hands(outcome))


def test_so_is_one_whose_files_or_software_have_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of(tmp_path)
    run(tmp_path / "out", plan, Hands(outcome))
    (tmp_path / "pocket.json").write_text("{}")
    with pytest.raises(DisagreementError, match=r"pocket\.json was"):
        StudyFolder(tmp_path / "out", Plan(plan.study, ("stagectl",), tmp_path))
    monkeypatch.setattr("rigkit.study.folder.software", lambda: "vibrostage 9")
    with pytest.raises(DisagreementError, match=r'software was "vibrostage 0.*, is "vibrostage 9"'):
        StudyFolder(tmp_path / "out", plan)
    with StudyFolder(tmp_path / "out", plan, ["software"]) as folder:
        assert folder.notes[0].endswith("accepted")


def test_what_is_no_study_is_left_alone_and_two_programs_do_not_share_one(tmp_path: Path) -> None:
    plan, other = plan_of(tmp_path), tmp_path / "other"
    other.mkdir()
    (other / "a.txt").write_text("mine")
    with pytest.raises(ValueError, match=r"other/ is in use: it holds a\.txt"):
        StudyFolder(other, plan)
    assert [file.name for file in other.iterdir()] == ["a.txt"]
    with StudyFolder(tmp_path / "out", plan), pytest.raises(FolderInUseError, match="in use by process"):
        StudyFolder(tmp_path / "out", plan)
