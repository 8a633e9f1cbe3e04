"""Old runs make room for new ones; what is marked, at work, the newest, or no run at all, stays."""

import os
import shutil
import time
from pathlib import Path

import pytest

from rigkit.retention import DAY, FIRST, Policy, StoredRun, delete, stored_runs, superfluous
from rigkit.run_folder import RunFolder
from vibractl.__main__ import main

NOW = 1_000 * DAY
NEWEST = FIRST + 100 * DAY


def run(number: int, size: int = 100, marked: bool = False) -> StoredRun:
    """Return a run that is so many days old."""
    return StoredRun(Path(f"run-{number}"), size, NOW - number * DAY, marked)


@pytest.mark.parametrize(
    ("policy", "deleted"),
    [
        (Policy(), []),
        (Policy(newest=3), [3, 5]),
        (Policy(newest=1), [1, 2, 3, 5]),
        (Policy(days=2.5), [3, 5]),
        (Policy(days=0), [1, 2, 3, 5]),
        (Policy(size=300), [3, 5]),
        (Policy(size=0), [1, 2, 3, 5]),
        (Policy(newest=4, days=1.5), [2, 3, 5]),
    ],
)
def test_what_is_beyond_any_limit_goes_but_never_the_newest_or_what_is_marked(
    policy: Policy, deleted: list[int]
) -> None:
    runs = [run(0), run(1), run(2), run(3), run(4, marked=True), run(5)]
    assert [each.path.name for each in superfluous(runs, policy, NOW)] == [f"run-{number}" for number in deleted]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Make five runs, the first the newest; a folder, a file and a link that are none."""
    for number in range(5):
        path = tmp_path / f"run-{number}"
        with RunFolder.create(path, "[rig]\n") as folder:
            folder.write(f"shots/{folder.shot(0).name}", b"x" * 1_000)
        for file in path.rglob("*"):
            os.utime(file, (0, NEWEST - number * DAY))
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "config.toml").write_text("mine")
    (tmp_path / "thesis.txt").write_text("years of work")
    return tmp_path


def names(root: Path) -> list[str]:
    return sorted(path.name for path in root.iterdir())


def prune(monkeypatch: pytest.MonkeyPatch, root: Path, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["vibractl", "prune", str(root), *arguments])
    return main()


def test_runs_are_found_by_what_is_in_them_the_newest_first(root: Path) -> None:
    found = stored_runs(root)
    assert [each.path.name for each in found] == [f"run-{number}" for number in range(5)]
    assert {each.size for each in found} == {1_006}
    assert [each.changed for each in found] == [NEWEST - number * DAY for number in range(5)]


def test_a_file_from_the_future_makes_no_run_the_newest(root: Path) -> None:
    later = time.time() + 300 * DAY
    os.utime(root / "run-3" / "shots" / "0000.wav", (later, later))
    assert [each.path.name for each in stored_runs(root)] == [f"run-{number}" for number in range(5)]


@pytest.mark.parametrize("wrong", [300 * DAY, -9_000 * DAY])
def test_a_run_that_a_wrong_clock_has_dated_is_kept_and_takes_no_others_place(
    wrong: float, root: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Days later or earlier: a clock without its battery begins in 1970 or 2000."""
    for file in (root / "run-3").rglob("*"):
        os.utime(file, (0, time.time() + wrong))
    gone = [each.path.name for each in superfluous(stored_runs(root), Policy(newest=2), time.time())]
    assert gone == ["run-2", "run-4"]
    assert prune(monkeypatch, root, "--days", "1") == 0
    assert f"not deleted, implausible dates: {root / 'run-3'}\n" in capsys.readouterr().out
    assert names(root) == ["notes", "run-0", "run-3", "thesis.txt"]


def test_a_dry_run_deletes_nothing(
    root: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = names(root)
    assert prune(monkeypatch, root, "--newest", "2", "--dry-run") == 0
    told = capsys.readouterr().out
    assert told.count("would be deleted") == 4
    assert "would be deleted: 3 runs, 0.003018 MB" in told
    assert names(root) == before


def test_what_is_marked_or_at_work_is_kept_and_the_rest_goes(
    root: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (root / "run-3" / "keep").touch()
    os.utime(root / "run-3" / "keep", (0, 0))
    with RunFolder.open(root / "run-2"):
        assert prune(monkeypatch, root, "--newest", "1") == 0
    assert "in progress, not deleted" in capsys.readouterr().out
    assert names(root) == ["notes", "run-0", "run-2", "run-3", "thesis.txt"]


def test_a_run_behind_a_link_is_not_touched(root: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "run"
    shutil.move(root / "run-4", elsewhere)
    (root / "run-4").symlink_to(elsewhere)
    assert [each.path.name for each in stored_runs(root)] == [f"run-{number}" for number in range(4)]


def test_a_deletion_that_was_killed_leaves_no_run_and_is_finished_next_time(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(_: Path) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(shutil, "rmtree", killed)
        with pytest.raises(KeyboardInterrupt):
            delete(stored_runs(root)[-1])
    assert [each.path.name for each in stored_runs(root)] == [f"run-{number}" for number in range(4)]
    assert prune(monkeypatch, root, "--newest", "4") == 0
    assert names(root) == ["notes", "run-0", "run-1", "run-2", "run-3", "thesis.txt"]


def test_a_policy_that_keeps_everything_or_a_folder_that_is_not_there_is_one_line(
    root: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert prune(monkeypatch, root) == 2
    assert prune(monkeypatch, root / "absent", "--newest", "1") == 2
    errors = capsys.readouterr().err.splitlines()
    assert "prune needs at least one of --newest, --gigabytes and --days" in errors[0]
    assert "absent: there is no such folder" in errors[1]
    assert len(errors) == 2
