"""A run of the vibrator on a disk that fails at any call, is full at any size, or when no more files may be open.

Guards against parts of files that pass for whole ones, runs that cannot be taken up again, and faults without a name.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.rigkit.failing_calls import every_fault
from tests.scenario.failing_disk import check, check_the_end, learn
from tests.until import EVER
from tests.vibractl.linear_rig import linear_model

QUICK = 29
"""From one call that fails to the next, in `make test`."""


pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
"""A call that fails may be one of multiprocessing's own, as it frees memory."""


def fail_and_take_up(folder: Path, patch: pytest.MonkeyPatch, stride: int) -> int:
    """Let calls fail, and return how many did; every run must go on to its end."""
    model, failed = linear_model(folder), 0
    learn(folder / "whole", model)
    for place, fault in every_fault(lambda place: learn(place / "run", model), folder, patch, stride):
        path = place / "run"
        if fault is not None:
            failed += 1
            assert str(fault)
            if path.exists():
                check(path)
            learn(path, model)
        check_the_end(path, folder / "whole")
    return failed


@pytest.mark.slow
def test_a_call_that_fails_leaves_no_part_of_a_file_and_the_run_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert fail_and_take_up(tmp_path, monkeypatch, QUICK) >= 5


@pytest.mark.slow
def test_whichever_call_fails_no_part_of_a_file_is_left_and_the_run_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert fail_and_take_up(tmp_path, monkeypatch, 1) >= 100


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "fewest"), [("size", 8), ("files", 3)])
def test_a_limit_of_the_system_leaves_no_part_of_a_file_and_the_run_goes_on(
    kind: str, fewest: int, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "tests.scenario.failing_disk", kind, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=EVER, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) >= fewest
