"""Tests in real time: repeated where the machine stood still for longer than they may, and only there."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.contract.source_tree import ROOT
from tests.deadlines import STOOD, Excuse
from tests.until import EVER

FAILS = """
import pathlib, sys, time, pytest

@pytest.mark.deadline(0.05)
def test_of_a_deadline():
    times = pathlib.Path("times")
    times.write_text(times.read_text() + "x" if times.exists() else "x")
    interval = sys.getswitchinterval()
    sys.setswitchinterval(100.0)  # nothing else of this process runs in the meantime
    end = time.monotonic() + {stands_still}
    while time.monotonic() < end:
        pass
    sys.setswitchinterval(interval)
    time.sleep(0.02)
    assert len(times.read_text()) >= {passes_at}
"""
CONFIGURATION = f"""
[pytest]
addopts = -p tests.deadlines
markers = deadline
pythonpath = {ROOT}
"""


def run(folder: Path, stands_still: float, passes_at: int, workers: int = 0) -> tuple[str, int]:
    """Run a test that fails until it has run so often; return what is said and how often it ran."""
    (folder / "pytest.ini").write_text(CONFIGURATION)
    (folder / "test_it.py").write_text(FAILS.format(stands_still=stands_still, passes_at=passes_at))
    command = [sys.executable, "-m", "pytest", "-n", str(workers), "test_it.py"]
    done = subprocess.run(
        command, cwd=folder, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, timeout=EVER, check=False
    )
    return done.stdout + done.stderr, len((folder / "times").read_text())


@pytest.mark.sample(1)
@pytest.mark.parametrize("workers", [0, 1])
def test_it_is_repeated_where_the_machine_stood_still_and_says_so(tmp_path: Path, workers: int) -> None:
    said, times = run(tmp_path, 0.2, 3, workers)
    assert "1 passed, 2 rerun" in said, said
    assert times == 3
    assert said.count("repeated: test_it.py::test_of_a_deadline: the machine stood still for 0.") == 2
    assert "the limit is 0.05 s" in said


def test_a_fault_of_the_programs_own_is_one_however_often_the_machine_stood_still(tmp_path: Path) -> None:
    said, times = run(tmp_path, stands_still=0.1, passes_at=100)
    assert "1 failed, 8 rerun" in said, said
    assert times == 9


def test_a_failure_that_the_machine_does_not_excuse_is_not_repeated() -> None:
    item = SimpleNamespace(stash={STOOD: SimpleNamespace(longest=0.05)}, config=SimpleNamespace(stash={}), nodeid="it")
    assert not Excuse(item, 0.05)(AssertionError())  # type: ignore[arg-type]
