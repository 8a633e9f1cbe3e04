"""What an export costs: bytes read and written in step with the shots, and no more than a few of them in memory."""

import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from ctlblocks import recording
from tests.vibractl.export.exported_run import recorded_run
from vibractl.export.content import Content, read_content
from vibractl.export.csv import write_csv
from vibractl.export.mat import write_mat
from vibractl.export.parquet import write_parquet
from vibractl.export.run import FORMATS, write_mcap_of_run
from vibractl.export.segy import write_segy
from vibractl.export.uff import write_uff

pytestmark = pytest.mark.slow  # tracemalloc takes its time
SAMPLES = 4_096
"""Of a shot here."""
COUNTERS = Path("/proc/self/io")
"""Bytes that this process has read and written, as Linux counts them: the same on any machine, however busy."""
WRITERS: dict[str, Callable[[Path, Content], object]] = {
    "uff": lambda folder, content: write_uff(folder / "run.uff", content),
    "segy": lambda folder, content: write_segy(folder / "run.sgy", content),
    "mat": lambda folder, content: write_mat(folder / "run.mat", content),
    "mcap": lambda folder, content: write_mcap_of_run(folder / "run.mcap", content),
    "csv": write_csv,
    "parquet": write_parquet,
}


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Content:
    """One shot of a run, cut short."""
    folder = tmp_path_factory.mktemp("run")
    content = read_content(recorded_run(folder), "0")
    part, shot = slice(content.lead, content.lead + SAMPLES), content.shot(0)
    recording.write(folder / "short.wav", replace(shot, data=shot.data[part].copy()))
    files = {0: folder / "short.wav"}
    return replace(content, reference=content.reference[part], lead=0, frames=SAMPLES, files=files)


def of_shots(short: Content, count: int) -> Content:
    """Return a run of so many shots, all alike."""
    return replace(short, files=dict.fromkeys(range(count), short.files[0]))


def moved() -> int:
    """Return the bytes that this process has read and written so far."""
    counts = dict(line.split(": ") for line in COUNTERS.read_text().splitlines())
    return int(counts["rchar"]) + int(counts["wchar"])


def test_every_format_is_measured_here() -> None:
    assert set(WRITERS) == set(FORMATS)


@pytest.mark.skipif(not COUNTERS.exists(), reason="nobody counts the bytes of a process here")
@pytest.mark.parametrize("name", FORMATS)
def test_twice_the_shots_move_twice_the_bytes(name: str, short: Content, tmp_path: Path) -> None:
    bytes_moved = []
    for count in (1, 1, 6, 11):  # once more for what Python imports
        before = moved()
        WRITERS[name](tmp_path, of_shots(short, count))
        bytes_moved.append(moved() - before)
    first, second = bytes_moved[2] - bytes_moved[1], bytes_moved[3] - bytes_moved[2]
    assert second == pytest.approx(first, rel=0.05)


@pytest.mark.parametrize("name", FORMATS)
def test_twice_the_shots_take_the_same_memory(name: str, short: Content, tmp_path: Path) -> None:
    WRITERS[name](tmp_path, of_shots(short, 1))  # imports what it needs
    peaks = []
    for count in (6, 12):  # 5 fill the largest chunk of MCAP
        tracemalloc.start()
        try:
            WRITERS[name](tmp_path, of_shots(short, count))
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
    assert peaks[1] - peaks[0] < 3 * short.shot(0).data.nbytes
