"""Ms of calibrated loops on the simulated plants themselves, linearised.

`python -m benchmarks.stage_robustness [SEED ...]`, for the stages that `benchmarks.stage_chain` has calibrated.  The
plant is its modes, all of them, behind amplifier and the stacks' gain at small amplitude; loops have one sample of
delay more than there is.  `PID, 720 Hz` is a fast inner loop with proportional part and lead, beside the calibrated.
"""

from pathlib import Path

import numpy as np
from scipy.linalg import block_diag, expm

from benchmarks.page_table import table, words
from benchmarks.stage_chain import AXES, FOLDER, RATE, SEEDS
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from firmware_sim.plants.piezo_stage_actuator import AMPLIFIER_CORNER, VOLTAGE
from firmware_sim.plants.piezo_stage_modes import PIEZO_STIFFNESS
from rigkit import config as rig_file
from stagectl.config import Inner, StageConfig
from stagectl.models.model_file import read_model
from stagectl.stage.design import design
from stagectl.stage.piezo_pid import Pid, pid
from stagectl.stage.sensitivity import Robustness, robustness
from stagectl.stage.state_space import StateSpace
from stagectl.stage.weights import chosen_weights

FAST = Inner(gain=(0.0894e-6,), bandwidth=(720.0,), proportional=0.17, lead=4.3e-5)
DELAY = 1
"""Samples more than there are."""


def linearised(seed: int, axis: int, scale: float) -> tuple[StateSpace, np.ndarray]:
    """Return an axis from voltage (V) to what the gauge shows (m), and the row that gives the position instead."""
    plant = PiezoStagePlant(RATE, seed=seed, frequency_scale=scale)
    modes, stack = plant.modes, plant._actuators[axis]  # noqa: SLF001 (the truth is nobody else's business)
    omega, gain = 2 * np.pi * modes.frequency, stack[0] * stack[2] / VOLTAGE
    steps, drives = [], []
    for each, damping, shape in zip(omega, modes.damping, modes.extension[axis], strict=True):
        drift = np.array([[0.0, each], [-each, -2 * damping * each]])
        drive = np.array([[0.0], [PIEZO_STIFFNESS * shape * gain]])
        held = expm(np.block([[drift, drive], [np.zeros((1, 3))]]) / RATE)
        steps.append(held[:2, :2])
        drives.append(held[:2, 2:])
    pole, n = np.exp(-2 * np.pi * AMPLIFIER_CORNER / RATE), 2 * len(omega)
    inlet = np.vstack(drives)
    seen = np.zeros((2, n + 1))
    seen[0, :n:2], seen[1, :n:2] = modes.extension[axis] / omega, modes.plate[axis] / omega
    mechanics = block_diag(*steps, [[pole]])
    mechanics[:n, n:] = pole * inlet
    whole = np.block([[mechanics, np.zeros((n + 1, 2))], [seen, np.zeros((2, 2))]])
    start = np.vstack([(1 - pole) * inlet, [[1 - pole], [0.0], [0.0]]])
    rows = np.eye(n + 3)[n + 1 :]
    return StateSpace(whole, start, rows[:1], np.zeros((1, 1))), rows[1:]


def closed(stack: StateSpace, position: np.ndarray, loop: Pid) -> StateSpace:
    """Return an axis from the inner loop's reference (m) to its position (m)."""
    control = loop.system(RATE)
    return StateSpace(
        np.block(
            [
                [stack.A - stack.B @ control.D @ stack.C, stack.B @ control.C],
                [-control.B @ stack.C, control.A],
            ]
        ),
        np.vstack([stack.B @ (control.D + loop.feedforward), control.B]),
        np.hstack([position, np.zeros((1, len(control.A)))]),
        np.zeros((1, 1)),
    )


def row_of(seed: int, axis: int, folder: Path) -> list[str]:
    """Return the row of an axis."""
    rig = rig_file.load(folder / "stage.toml", StageConfig)
    model = read_model(folder / f"stage-{AXES[axis]}.h5", rate=RATE)
    found, loop = design(model, rig.outer, axis, chosen_weights(rig.weights, axis)), pid(rig.inner, axis)
    plants = [linearised(seed, axis, scale) for scale in (0.95, 1.0, 1.05)]
    outer = [robustness(closed(*plant, loop), found.loop.system(), RATE, DELAY) for plant in plants]
    inner = [robustness(plants[1][0], each.system(RATE), RATE, DELAY) for each in (pid(FAST, axis), loop)]
    return [str(seed), AXES[axis], *map(_said, inner), f"{found.robustness.max_sensitivity:.2f}", *map(_said, outer)]


def _said(figures: Robustness) -> str:
    return f"{figures.max_sensitivity:.2f}" if figures.stable else "unstable"


def main() -> None:
    """Print the table."""
    seeds = [int(text) for text in words()] or SEEDS
    rows = [row_of(seed, axis, FOLDER / f"seed-{seed}") for seed in seeds for axis in range(len(AXES))]
    head = ["seed", "axis", "PID, 720 Hz", "inner loop", "outer, model", "outer, -5 %", "outer", "outer, +5 %"]
    print(table(head, rows))


if __name__ == "__main__":
    main()
