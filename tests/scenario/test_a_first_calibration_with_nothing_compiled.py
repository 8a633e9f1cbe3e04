"""An array's first calibration on a machine that has compiled nothing yet, beside a card with a clock of its own.

It died once: seconds of compilation in the first callback were a stream that stood still, and on a busy machine the
audio process had not opened its stream in time.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rigkit import config as rig_file
from tests.calibration.far_field_rig import array_config

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_it_ends_in_a_model_and_discards_no_recording(tmp_path: Path) -> None:
    quick = ("band=[100, 130]", "records=6", "period=1")
    (tmp_path / "rig.toml").write_text(rig_file.dump(array_config(2, 1, *quick)))
    simulator = ["--set", "simulator.plant=vibrator-array", "--set", "simulator.speed=1"]
    done = subprocess.run(
        [sys.executable, "-m", "calibration", "vibrator", "--config", tmp_path / "rig.toml", *simulator]
        + ["--out", tmp_path / "model.h5"],
        cwd=ROOT,
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "compiled")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "discarded" not in done.stderr
    assert (tmp_path / "model.h5").is_file()
