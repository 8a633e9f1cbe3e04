"""The examples that need nothing but this package run, and show what they say."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ctlblocks.recording import read

EXAMPLES = Path(__file__).parents[2] / "examples"


def run(name: str, file: Path) -> str:
    done = subprocess.run([sys.executable, EXAMPLES / name, file], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_the_loop_settles_at_its_reference(tmp_path: Path) -> None:
    said = run("closed_loop.py", tmp_path / "loop.csv")
    assert re.search(r"loop.csv: position 1\.00\d\d m after 2 s, overshoot \d+\.\d%", said)
    result = read(tmp_path / "loop.csv", rate=1000.0, names=["position", "drive"])
    assert result.units == ("m", "V")
    assert len(result.data) == 2000
    assert result.data[-1] == pytest.approx([1.0, 1.0], abs=0.01)
    assert np.abs(result.data[:, 1]).max() == 2.0  # the amplifier's limit was met


def test_the_replay_is_bit_for_bit(tmp_path: Path) -> None:
    said = run("replay_bit_for_bit.py", tmp_path / "replay.wav")
    assert re.search(r"replay.wav: 1600 samples, \d+ ticks late, replayed bit for bit", said)
