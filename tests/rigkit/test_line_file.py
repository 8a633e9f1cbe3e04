"""Files that grow by a line."""

import errno
import os
from pathlib import Path

import pytest

from rigkit import line_file


def test_lines_are_added_and_read(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    line_file.append(path, "one é")
    line_file.append(path, "two")
    assert line_file.lines(path) == ["one é", "two"]


def test_an_absent_file_has_no_lines_and_needs_no_repair(tmp_path: Path) -> None:
    line_file.repair(tmp_path / "events.jsonl")
    assert line_file.lines(tmp_path / "events.jsonl") == []
    assert list(tmp_path.iterdir()) == []


def test_a_torn_last_line_is_not_read_even_inside_a_character(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    path.write_bytes("one\ntwö".encode()[:-1])
    assert line_file.lines(path) == ["one"]


def test_after_a_repair_the_next_line_stands_on_its_own(tmp_path: Path) -> None:
    path = tmp_path / "events.jsonl"
    path.write_bytes(b"one\ntw")
    line_file.repair(path)
    line_file.append(path, "three")
    assert path.read_bytes() == b"one\nthree\n"


def test_a_line_with_a_break_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="more than one line"):
        line_file.append(tmp_path / "events.jsonl", "one\ntwo")


def test_a_full_disk_leaves_the_lines_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Which takes a part, and nothing more."""
    path = tmp_path / "events.jsonl"
    line_file.append(path, "one")
    write = os.write

    def two_bytes(handle: int, content: bytes) -> int:
        if content != b"two\n":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(handle, content[:2])

    monkeypatch.setattr(os, "write", two_bytes)
    with pytest.raises(OSError, match="No space left"):
        line_file.append(path, "two")
    assert path.read_bytes() == b"one\n"


def test_a_disk_that_fails_when_half_is_written_leaves_the_lines_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "events.jsonl"
    line_file.append(path, "one")
    write = os.write

    def half(handle: int, content: bytes) -> int:
        write(handle, content[:2])
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    with monkeypatch.context() as patched:
        patched.setattr(os, "write", half)
        with pytest.raises(OSError, match="Input/output error"):
            line_file.append(path, "two")
    line_file.append(path, "three")
    assert line_file.lines(path) == ["one", "three"]


def test_the_first_line_is_read_once_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "qc.csv"
    assert line_file.first(path) == ""
    path.write_bytes(b"sho")
    assert line_file.first(path) == ""
    path.write_bytes(b"shot,level\n0,1\n")
    assert line_file.first(path) == "shot,level"
