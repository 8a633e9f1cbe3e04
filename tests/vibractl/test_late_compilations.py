"""Nothing is compiled while a stream is open: seconds in the first callback were a stream that stood still."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow  # all is compiled anew


@pytest.fixture(scope="module")
def late() -> dict[str, list[str]]:
    """Return what each way to open a stream compiles too late, in a program that has compiled nothing."""
    command = [sys.executable, "-m", "tests.vibractl.late_compilations"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


@pytest.mark.parametrize(
    "case",
    [
        "run",
        "run by the thesis' law",
        "run of one side by marker",
        "run before hydrophones",
        "run of impulse responses",
        "run with the stream in a process of its own",
        "calibrate by multisines",
        "calibrate by a stepped sine",
        "calibrate an array of vibrators",
        "doctor",
    ],
)
def test_all_is_compiled_before_the_stream_is_open(late: dict[str, list[str]], case: str) -> None:
    assert late[case] == []
