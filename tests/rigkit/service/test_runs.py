"""What has been recorded is listed and found, and nothing else is."""

import os
from pathlib import Path

import pytest

from rigkit.service import runs


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Return a folder with two runs, `new` and `old`, and with what is none of anybody's business."""
    made = tmp_path / "runs"
    (made / "old" / "shots").mkdir(parents=True)
    (made / "new").mkdir()
    (made / ".hidden").mkdir()
    (made / "note.txt").write_text("no run")
    (made / "old" / "shots" / "0000.wav").write_bytes(b"12345")
    (made / "old" / "report.html").write_text("<p>")
    (made / "old" / ".lock").write_text("")
    (tmp_path / "token").write_text("secret")
    (made / "old" / "secret").symlink_to(tmp_path / "token")
    (made / "old" / "up").symlink_to(tmp_path)
    os.utime(made / "old", (1_000.0, 1_000.0))
    return made


def test_runs_are_listed_the_newest_first(root: Path) -> None:
    listed = runs.listed(root)
    assert [run["name"] for run in listed] == ["new", "old"]
    assert listed[1]["time"] == "1970-01-01T00:16:40.000+00:00"


def test_no_folder_has_no_runs(tmp_path: Path) -> None:
    assert runs.listed(tmp_path / "runs") == []


def test_the_files_of_a_run_are_listed_and_found_and_neither_hidden_nor_foreign_ones(root: Path) -> None:
    found = runs.files(root, "old")
    assert [(file["path"], file["size"]) for file in found] == [("report.html", 3), ("shots/0000.wav", 5)]
    assert [runs.file(root, "old", str(file["path"])).is_file() for file in found] == [True, True]
    assert runs.files(root, "new") == []


def test_a_name_that_is_no_text_is_left_out(root: Path) -> None:
    (root / "old" / os.fsdecode(b"\xff.wav")).write_text("")
    (root / os.fsdecode(b"\xfe")).mkdir()
    assert len(runs.files(root, "old")) == 2
    assert len(runs.listed(root)) == 2


@pytest.mark.parametrize("run", ["..", ".", "", ".hidden", "old/..", "/etc", "up"])
def test_what_is_no_run_has_no_files(root: Path, run: str) -> None:
    (root / "up").symlink_to(root.parent)
    with pytest.raises(PermissionError):
        runs.files(root, run)
    with pytest.raises(PermissionError):
        runs.file(root, run, "token")


@pytest.mark.parametrize("run", ["older", "note.txt"])
def test_a_run_that_is_not_there_is_missed_by_name(root: Path, run: str) -> None:
    with pytest.raises(LookupError, match=f"there is no run '{run}'"):
        runs.files(root, run)


@pytest.mark.parametrize("path", ["../../token", "secret", "up/token", ".lock", "shots//0000.wav", "shots\\0000.wav"])
def test_what_is_outside_of_a_run_or_hidden_is_refused(root: Path, path: str) -> None:
    with pytest.raises(PermissionError):
        runs.file(root, "old", path)


@pytest.mark.parametrize("path", ["shots", "shots/0001.wav"])
def test_a_file_that_is_not_there_is_missed_by_name(root: Path, path: str) -> None:
    with pytest.raises(LookupError, match=f"there is no file '{path}' in the run 'old'"):
        runs.file(root, "old", path)
