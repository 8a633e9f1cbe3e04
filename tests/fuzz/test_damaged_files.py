"""Damaged files and frames by the thousand are refused by our own error, or read as what they say.

Guards against a wrong rate, a wrong length or a NaN that is read in silence, errors that tell nobody what is wrong,
seconds or gigabytes spent on a file of kilobytes, and parsers that crash.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzz.child import MOST_FINDINGS

QUICK = {
    "wav": 500, "growing": 100, "csv": 200, "foreign": 200, "sounds": 300, "tables": 225,
    "arrays": 60, "toml": 200, "json": 400, "can": 10_000, "wires": 2_000,
    "hdf5": 20, "mcap": 200,
}  # fmt: skip
WHOLE = {
    "wav": 100_000, "growing": 10_000, "csv": 20_000, "foreign": 20_000, "sounds": 60_000, "tables": 60_000,
    "arrays": 40_000, "toml": 20_000, "json": 20_000,
    "can": 1_000_000, "wires": 200_000, "hdf5": 5_000, "mcap": 20_000,
}  # fmt: skip
PROCESSES = 20
"""In which the whole is done: what leaks would take more and more."""


@pytest.mark.sample(6)
@pytest.mark.parametrize("kind", QUICK)
def test_a_damaged_file_is_refused_or_read_as_what_it_says(kind: str, tmp_path: Path) -> None:
    accepted = judged(kind, tmp_path, 0, QUICK[kind])
    assert 0 < accepted < QUICK[kind]


@pytest.mark.slow
@pytest.mark.parametrize("kind", WHOLE)
@pytest.mark.timeout(7_200)
def test_so_is_each_of_many_more(kind: str, tmp_path: Path) -> None:
    part = WHOLE[kind] // PROCESSES
    assert sum(judged(kind, tmp_path, first, part) for first in range(0, WHOLE[kind], part)) > 0


def judged(kind: str, folder: Path, first: int, count: int) -> int:
    """Return how many of the files are accepted; fails with what was found."""
    command = [sys.executable, "-m", "tests.fuzz.child", kind, str(folder), str(first), str(count)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=3_600, check=False)
    if done.returncode:
        number = (folder / "at").read_text() if (folder / "at").exists() else first
        raise AssertionError(f"{kind} {number} ends the process ({done.returncode}): {done.stderr[-2_000:]}")
    accepted, *findings = done.stdout.splitlines()
    assert not findings, f"{len(findings)} findings, at most {MOST_FINDINGS} are told:\n" + "\n".join(findings)
    return int(accepted)
