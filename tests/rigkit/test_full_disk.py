"""Whatever is written: a disk that is full or fails is told by file, folder, and the room that is left and wanted."""

import errno
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
import scipy.io
import segyio
from matplotlib.figure import Figure

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import DiskFault
from rigkit import atomic, line_file
from rigkit.export.mcap_file import write_mcap
from rigkit.growing_wav import Channels, GrowingWav
from rigkit.model_file import ModelFile, write_model_file
from rigkit.report import Plot, Report, Section
from rigkit.service.not_begun import reason
from tests.rigkit.small_disk import SIZE, Disk, full, limited, read_only

NOISE = np.random.default_rng(1).normal(size=(SIZE // 4, 1))
RECORD = Recording(("a",), ("V",), 44_100, NOISE)
LARGE = Path(pyarrow.lib.__file__)
EVERY_DISK = pytest.mark.parametrize("disk", [full, limited, read_only])


def through(write: Callable[[Path], object]) -> Callable[[Path], None]:
    """Return what writes a file under its temporary name, as every exporter does."""

    def replace(path: Path) -> None:
        with atomic.replacing(path) as temporary:
            write(temporary)

    return replace


def _segy(path: Path) -> None:
    layout = segyio.spec()
    layout.samples, layout.tracecount, layout.format = list(range(2_000)), 50, 5
    with segyio.create(str(path), layout) as file:
        for number in range(layout.tracecount):
            file.trace[number] = np.ones(2_000, np.float32)


def _picture() -> Figure:
    figure = Figure(figsize=(8, 8))
    figure.add_subplot().imshow(np.random.default_rng(1).random((1_000, 1_000)), interpolation="nearest")
    return figure


def _growing(path: Path) -> None:
    with GrowingWav(path, Channels(("a",), ("V",), 10_000.0, {})) as file:
        for _ in range(4):
            file.append(NOISE)


WRITERS: dict[str, Callable[[Path], object]] = {
    "a.wav": lambda path: recording.write(path, RECORD),
    "a.csv": lambda path: recording.write(path, RECORD),
    "growing.wav": _growing,
    "model.h5": lambda path: write_model_file(path, ModelFile("test", {"a": NOISE})),
    "run.mat": through(lambda path: scipy.io.savemat(str(path), {"a": NOISE})),
    "run.sgy": through(_segy),
    "run.mcap": through(lambda path: write_mcap(path, iter([("/a", RECORD)]), {}, [])),
    "run.parquet": through(lambda path: pyarrow.parquet.write_table(pyarrow.table({"a": NOISE[:, 0]}), path)),
    "run.npy": through(lambda path: np.save(path, NOISE)),
    "figure.png": through(lambda path: _picture().savefig(path)),
    "copy.h5": through(lambda path: shutil.copyfile(LARGE, path)),
    "report.html": lambda path: Report("a", "b", (), (Section("s", plots=(Plot(_picture(), ""),)),)).write(path),
    "events.jsonl": lambda path: line_file.append(path, "x" * (2 * SIZE)),
    "text.json": lambda path: atomic.write(path, "x" * (2 * SIZE)),
}


@pytest.mark.sample(3)
@EVERY_DISK
@pytest.mark.parametrize("name", WRITERS)
def test_a_file_that_the_disk_does_not_take_is_named_with_the_room_and_nothing_is_left(
    name: str, disk: Disk, tmp_path: Path
) -> None:
    with disk(tmp_path) as (folder, why):
        with pytest.raises((OSError, ValueError)) as raised:
            WRITERS[name](folder / name)
        left = [file.name for file in folder.iterdir() if file.is_file() and file.stat().st_size]
    fault, said = raised.value, reason(raised.value)
    assert isinstance(fault if isinstance(fault, OSError) else fault.__cause__, DiskFault)
    assert re.fullmatch(
        rf"{folder / name}: {why}: [\d.e+]+ MB are free in {folder}/, (more is|[\d.e+-]+ MB are) wanted", said
    )
    assert [file for file in left if not file.startswith("growing")] == []


def test_a_disk_that_fails_as_it_is_waited_for_is_named_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: int) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(os, "fsync", fail)
    for name in ("a.wav", "model.h5", "text.json"):
        with pytest.raises((OSError, ValueError)) as raised:
            WRITERS[name](tmp_path / name)
        assert reason(raised.value).startswith(f"{tmp_path / name}: Input/output error: ")
    assert list(tmp_path.iterdir()) == []


def test_a_fault_that_is_no_disks_stays_what_it_is(tmp_path: Path) -> None:
    """A file that is read meanwhile, and a library that refuses, on a disk that has room."""

    def fail(_: Path) -> None:
        raise fault

    for fault in (FileNotFoundError(errno.ENOENT, "absent", "other.h5"), OSError("no such card"), ValueError("no")):
        with pytest.raises(type(fault)) as raised:
            through(fail)(tmp_path / "a")
        assert raised.value is fault
