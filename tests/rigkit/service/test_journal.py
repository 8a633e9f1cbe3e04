"""The event log: in memory at once, on the disk when the disk can."""

import json
import os
from pathlib import Path

import pytest

from rigkit import line_file
from rigkit.service import journal as module
from rigkit.service.journal import Journal
from tests.until import until


def test_events_are_numbered_kept_and_written(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "events.jsonl")
    for shot in range(3):
        journal.add("shot", "run", {"shot": shot})
    assert [entry["shot"] for entry in journal.since(1)] == [1, 2]
    assert [entry["shot"] for entry in journal.since(0, most=1)] == [2]
    journal.close(60)
    written = [json.loads(line) for line in line_file.lines(tmp_path / "events.jsonl")]
    assert written == journal.since(0)
    assert [entry["number"] for entry in written] == [1, 2, 3]


def test_a_line_that_a_kill_cut_short_is_taken_away(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    path.write_text('{"event": "whole"}\n{"event": "cut')
    journal = Journal(path)
    journal.add("next", "run", {})
    journal.close(60)
    assert [json.loads(line)["event"] for line in line_file.lines(path)] == ["whole", "next"]


def test_a_disk_that_stalls_holds_nobody_up_and_what_it_misses_is_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pipe that nobody reads stands for the disk: opening it for writing waits."""
    os.mkfifo(tmp_path / "stalled")
    monkeypatch.setattr(line_file, "repair", lambda _: None)
    monkeypatch.setattr(module, "WAITING", 10)
    journal = Journal(tmp_path / "stalled")
    for number in range(100):
        journal.add("event", "run", {"n": number})
    assert len(journal.since(0)) == 100
    assert journal.unwritten >= 89
    assert "events are not on the disk" in journal.fault
    reader = os.open(tmp_path / "stalled", os.O_RDONLY | os.O_NONBLOCK)
    journal.close(60)
    os.close(reader)


def test_a_disk_that_is_full_is_told_and_taken_up_again(tmp_path: Path) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    journal = Journal(folder / "events.jsonl")
    folder.rmdir()
    journal.add("lost", "run", {})
    until(lambda: journal.unwritten)
    assert "No such file" in journal.fault
    folder.mkdir()
    journal.add("kept", "run", {})
    journal.close(60)
    assert [json.loads(line)["event"] for line in line_file.lines(folder / "events.jsonl")] == ["kept"]
    assert journal.fault == "1 events are not on the disk"


def test_a_file_that_has_grown_gives_way(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LARGEST", 200)
    path = tmp_path / "events.jsonl"
    journal = Journal(path)
    for number in range(10):
        journal.add("event", "run", {"n": number})
    journal.close(60)
    both = line_file.lines(path.with_name("events.jsonl.1")) + line_file.lines(path)
    assert path.stat().st_size < 400
    assert json.loads(both[-1])["n"] == 9
