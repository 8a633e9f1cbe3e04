"""A run for which there is no room is refused in one line that says how much it needs and how much there is."""

import shutil
from collections import namedtuple
from pathlib import Path

import pytest

from ctlblocks.room import free
from rigkit import disk_space

Usage = namedtuple("Usage", "total used free")


def leave(free: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(0, 0, int(free)))


def test_too_little_room_is_told_with_both_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    leave(100e6, monkeypatch)
    with pytest.raises(OSError, match=r"40 shots may take 60 MB, 100 MB are free and 67.11 MB of it stay so") as fault:
        disk_space.require(tmp_path / "absent" / "run", 60_000_000, "40 shots")
    assert fault.value.filename == str(tmp_path / "absent" / "run")
    leave(128e6, monkeypatch)
    disk_space.require(tmp_path / "absent" / "run", 60_000_000, "40 shots")


def test_the_room_is_looked_at_where_the_folder_will_be() -> None:
    assert free(Path("/nowhere/at/all")) == shutil.disk_usage("/").free
