"""A run of several setups goes on after a kill or a stop: what had come to its end stays, nothing recorded is lost.

Guards against a setup that is milled twice in steel, and against recordings of two attempts under one name.
"""

import shutil
from pathlib import Path

import pytest

from rigkit.experiment.again import replayed
from rigkit.experiment.kept import create, run
from rigkit.experiment.resumed import GoingOn, take_up
from rigkit.experiment.runner import STOPPED, Conduct
from rigkit.lock import FolderInUseError
from rigkit.run_folder import RunFolder, read_events
from stagectl.experiments.toroid.experiment import Toroid, unasked
from stagectl.experiments.toroid.read_back import TOROID, Files, left_of, setup_of_track
from stagectl.robot.config import CellConfig
from tests.stagectl.experiments.toroid.short_cell import STAGE, short

QUESTIONS = 30
"""After which its user stops a setup."""


def stopped_in_second(path: Path) -> None:
    made = Toroid([short("A"), short("B")])
    ended = list[str]()
    with create(path, TOROID, made.plans[0].cell, made, Files(STAGE).take_into) as folder:
        asked = 0

        def stopped() -> bool:
            nonlocal asked
            asked += bool(ended)
            return asked > QUESTIONS

        reasons, _ = run(folder, TOROID, made, Conduct(stopped, after=ended.append))
    assert reasons == {"B": STOPPED}


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stopped") / "run"
    stopped_in_second(path)
    return path


@pytest.fixture
def path(begun: Path, tmp_path: Path) -> Path:
    shutil.copytree(begun, tmp_path / "run", ignore=shutil.ignore_patterns(".lock"))
    return tmp_path / "run"


def go_on(path: Path) -> dict[str, str]:
    folder, experiment = take_up(path, GoingOn(CellConfig, lambda done: left_of(path, done, unasked), setup_of_track))
    with folder:
        reasons, _ = run(folder, TOROID, experiment, Conduct())
    return reasons


def test_the_setups_that_are_left_are_run_and_all_is_judged(path: Path) -> None:
    first = (path / "A-cell.wav").read_bytes()
    before = (path / "B-cell.wav").read_bytes()
    assert go_on(path) == {}
    assert (path / "A-cell.wav").read_bytes() == first, "not run again"
    assert (path / "before-1" / "B-cell.wav").read_bytes() == before, "nothing recorded is lost"
    assert (path / "B-cell.wav").read_bytes() != before
    events = [event["event"] for event in read_events(path)]
    assert events.count("resumed") == 1
    assert (path / "report.html").is_file()


def test_a_replay_is_of_the_last_attempt(path: Path) -> None:
    """The hold of the first is not that of the second."""
    go_on(path)
    done = list(replayed(path, TOROID))
    assert {each.recording for each in done} == {"A-cell", "B-cell"}
    assert all(each.identical for each in done)


@pytest.mark.slow
def test_a_second_attempt_may_be_killed_as_well(path: Path) -> None:
    for number in (1, 2):
        with pytest.raises(RuntimeError, match="the machine goes down"):
            _killed(path)
        assert (path / f"before-{number}" / "B-cell.wav").is_file()
    assert go_on(path) == {}
    assert len(list(path.glob("before-*/B-cell.wav"))) == 3
    assert all(each.identical for each in replayed(path, TOROID))


def _killed(path: Path) -> None:
    asked = 0

    def killed() -> bool:
        nonlocal asked
        asked += 1
        if asked > QUESTIONS:
            raise RuntimeError("the machine goes down")
        return False

    folder, experiment = take_up(path, GoingOn(CellConfig, lambda done: left_of(path, done, unasked), setup_of_track))
    with folder:
        run(folder, TOROID, experiment, Conduct(killed))


def test_one_that_is_whole_has_nothing_left_and_stays_as_it_is(path: Path) -> None:
    go_on(path)
    before = sorted(path.rglob("*"))
    with pytest.raises(ValueError, match="nothing is left of it: A, B came to the end"):
        go_on(path)
    assert sorted(path.rglob("*")) == before


def test_one_that_another_program_works_on_is_left_alone(path: Path) -> None:
    with RunFolder.open(path), pytest.raises(FolderInUseError):
        go_on(path)
    assert (path / "B-cell.wav").is_file()
