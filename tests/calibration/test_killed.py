"""Calibrations on the simulated robot killed in the midst of a motion: what was recorded is there, and goes on."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rigkit.experiment.kept import records_of
from rigkit.growing_wav import GROWING
from rigkit.run_folder import make_whole
from tests.calibration.joint_clamping.test_command import QUICK
from tests.calibration.milling.test_command import WORDS

pytestmark = pytest.mark.slow

LONG = 120.0
"""s that a motion may take to begin on a busy machine."""
JOINTS = ("joints", "--joints", "3,5", *(word for each in QUICK for word in ("--set", each)))
KINDS = {"clamping": JOINTS, "sweep": ("milling", *WORDS)}


def calibrate(place: Path, part: str) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "calibration", *KINDS[part], "--out", "model.h5"]
    return subprocess.Popen(words, cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def killed(place: Path, part: str, size: int) -> int:
    """Kill a calibration once so much of a part is recorded; return how much was, byte."""
    program, end = calibrate(place, part), time.monotonic() + LONG
    while time.monotonic() < end and program.poll() is None:
        there = sum(file.stat().st_size for file in (place / "model.raw").glob(f"{part}*{GROWING}"))
        if there > size:
            program.send_signal(signal.SIGKILL)
            program.communicate()
            return there
        time.sleep(0.01)
    program.kill()
    raise AssertionError(f"{part}: ended with {program.returncode}: {program.communicate()[1]!r}")


@pytest.mark.parametrize("part", KINDS)
def test_what_was_recorded_is_there_and_the_same_command_goes_on(tmp_path: Path, part: str) -> None:
    raw = tmp_path / "model.raw"
    for size in (100_000, 3_000_000):
        there = killed(tmp_path, part, size)
        make_whole(raw)
        record = list(records_of(raw, part).values())[-1]
        assert record.data.nbytes > 0.98 * there - 100_000
    program = calibrate(tmp_path, part)
    _, said = program.communicate()
    assert program.returncode == 0, said
    assert (tmp_path / "model.h5").is_file()
    kept = len(list(raw.glob("clamping-*.wav"))) if part == "clamping" else len(list(raw.glob("before-*/sweep.wav")))
    assert kept >= 2
