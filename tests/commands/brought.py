"""What a reader of docs/ brings along to its commands: records of machines of their own."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from stagectl.stage.hysteresis import HysteresisModel, respond
from tests.calibration.joint_clamping.clamped_arm import RATE, ClampedArm, random_joints, to_and_fro
from tests.contract.source_tree import ROOT


def loops(file: Path) -> None:
    """Write 20 s of a stack of 0 to 100 V and some 30 um, its hysteresis a fifth of that."""
    time = np.arange(10_000) / 500.0
    voltage = 50 - 50 * np.cos(2 * np.pi * time) * np.minimum(1, time / 10)
    parts = np.array([0, 1e-5, 0, 0]), np.zeros(2), np.zeros(2), np.array([0.2, 0.5]), np.array([5e-6, 4e-6])
    moved = 1e6 * respond(HysteresisModel(0.0, 100.0, *parts, 500.0, delay=1), voltage)
    _write(file, "u [V],y [um]", np.column_stack([voltage, moved]))


def clamped_joint(file: Path) -> None:
    """Write a joint's angle and torque, to and fro in its clamp."""
    arm = ClampedArm(random_joints(2))
    angle, torque, _ = arm.run(to_and_fro(arm, 2))
    time = np.arange(len(angle)) / RATE
    _write(file, "time,phi [rad],tau [N m]", np.column_stack([time, 121 * angle[:, 2], torque[:, 2] / 121]))


def poses(file: Path) -> None:
    """Write two poses of the clamped arm."""
    file.write_text("# deg\n0,0,0,0,30,0\n10,-10,5,0,40,10\n")


def sweep(file: Path) -> None:
    """Write the two positions that an input of two modes drives, and noise."""
    rng = np.random.default_rng(5)
    drive, noise = rng.standard_normal(6_000), 1e-3 * rng.standard_normal((6_000, 2))
    response = np.zeros((6_000, 2))
    for mode, frequency in enumerate((57.0, 96.0)):
        pole = 0.99 * np.exp(2j * np.pi * frequency / 1_000)
        for n in range(2, 6_000):
            past = response[n - 2 : n, mode]
            response[n, mode] = 2 * pole.real * past[1] - abs(pole) ** 2 * past[0] + drive[n - 1]
    _write(file, "u [V],y1 [m],y2 [m]", np.column_stack([drive, response + noise]))


def laboratory(folder: Path) -> None:
    """Let the laboratory of the examples write its files."""
    subprocess.run([sys.executable, ROOT / "examples" / "own_recordings.py", folder], check=True)


BROUGHT: dict[str, Callable[[Path], None]] = {
    "lab": laboratory,
    "loops.csv": loops,
    "map.csv": clamped_joint,
    "poses.csv": poses,
    "sweep.csv": sweep,
    "runs": Path.mkdir,
}


def _write(file: Path, head: str, columns: np.ndarray) -> None:
    np.savetxt(file, columns, delimiter=",", header=head, comments="", fmt="%.9g")
