"""A calibration killed at random moments until it is through: `python -m tests.calibration.killed_calibration DIR`.

Prints how many kills there were; fails unless the model is that of a calibration which nobody disturbed.
"""

import os
import random
import signal
import sys
import threading
import traceback
from pathlib import Path

import numpy as np

from calibration import vibrator_sweep
from calibration.experiment import RawFolder
from calibration.vibrator import calibrate
from rigkit import config as rig_file
from tests.calibration.linear_vibrator import ABOUT, emitter
from vibractl.config import RigConfig
from vibractl.model_file import read_model, write_model

KILLS = 8
SETTINGS = ("method=stepped", "band=[100, 109]", "tone=0.2", "settle=0.05")
CONFIG = rig_file.load(None, RigConfig, [f"characterisation.{text}" for text in SETTINGS])


def emit_from_rest(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each batch meets a plant at rest: then a recording does not depend on when it was made."""
    return emitter(1)(drive)


def work(folder: Path) -> None:
    with RawFolder(folder / "model.raw") as raw:
        write_model(folder / "model.h5", calibrate(CONFIG, raw, emit_from_rest, ABOUT).matrix)


def killed(folder: Path, seconds: float) -> bool:
    """Run in a child that is killed after so long; return whether it was."""
    child = os.fork()
    if child == 0:
        try:
            work(folder)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    timer = threading.Timer(seconds, os.kill, (child, signal.SIGKILL))
    timer.start()
    _, status = os.waitpid(child, 0)
    timer.cancel()
    assert os.WIFSIGNALED(status) or status == 0
    return os.WIFSIGNALED(status)


def main(folder: Path) -> None:
    vibrator_sweep.BATCH, vibrator_sweep.SILENCE = 2.0, 0.5
    for name in ("killed", "quiet"):
        (folder / name).mkdir()
    delays = random.Random(1)
    kills = 0
    while killed(folder / "killed", delays.uniform(0.01, 0.3) if kills < KILLS else 60.0):
        kills += 1
    work(folder / "quiet")
    found, expected = (read_model(folder / name / "model.h5") for name in ("killed", "quiet"))
    for name in ("frequency", "response", "variance", "coherence"):
        assert np.array_equal(getattr(found, name), getattr(expected, name)), name
    assert not list((folder / "killed").rglob("*.tmp*"))
    sys.stdout.write(f"{kills}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
