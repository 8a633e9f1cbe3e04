"""A run for which there is no room is refused in one line that says how much it needs and how much there is."""

import shutil
from collections import namedtuple
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
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
    assert disk_space.free(Path("/nowhere/at/all")) == shutil.disk_usage("/").free


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("suffix", ["wav", "csv"])
def test_no_recording_takes_more_than_is_said(tmp_path: Path, suffix: str, dtype: str) -> None:
    """Of numbers that are as long as numbers can be."""
    with np.errstate(over="ignore"):
        data = (np.random.default_rng(1).normal(size=(500, 3)) * -1e-30).astype(dtype)
    data[0] = -np.finfo(dtype).max
    data[1] = -np.finfo(dtype).tiny
    recording.write(tmp_path / f"x.{suffix}", Recording(("a", "b", "c"), ("m",) * 3, 44_100, data, {"rig": "x" * 500}))
    size = (tmp_path / f"x.{suffix}").stat().st_size
    assert size <= disk_space.bytes_of(500, 3, dtype, suffix)
    assert size >= 0.7 * disk_space.bytes_of(500, 3, dtype, suffix) - 2_000
