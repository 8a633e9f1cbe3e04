"""How far a cut of 100 N pushes the plate: outer loops designed with `outer.compliance` and without, side by side.

`python -m benchmarks.stage_compliance [SEED ...] [--write]`, half a minute an axis, on the stages that
`benchmarks.stage_chain` has calibrated.  The loops are designed anew on their models.  Answers at 10 and 30 Hz and Ms
are those of the plants themselves, linearised, all modes among them; Ms is the largest where natural frequencies are
off by 5 % either way, the gain by 20 % either way, and there is one sample of delay more.  The cut is the simulated
one, nonlinear, its force scaled to a mean of 100 N along the axis; the largest error is that of the worst of natural
frequencies off by 5 % or not, one sample of delay more.  Nothing else moves the plate: the robot is held.
"""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.page_table import put, table, words
from benchmarks.stage_chain import AXES, RATE, SECONDS, SEEDS, calibrated, simulated_run
from benchmarks.stage_robustness import closed, linearised
from calibration.stage_axes.calibration import outer_loop
from firmware_sim.plants.milling_disturbance import MEAN_FORCES
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.model_file import read_model
from stagectl.scenario import MILLING
from stagectl.session import error_of
from stagectl.setup import Setup, setup
from stagectl.stage.design import Design
from stagectl.stage.piezo_pid import pid
from stagectl.stage.sensitivity import robustness
from stagectl.stage.state_space import StateSpace
from stagectl.tracking import tracking

COMPLIANCE = 0.0, 1.0, 3.0
"""Of `outer.compliance`; the first is the default."""
FORCE = 100.0
"""N, mean along the cut."""
FREQUENCIES = np.array([10.0, 30.0])
OFF, GAINS, LATER = (0.95, 1.0, 1.05), (0.8, 1.0, 1.2), 1
"""Factors of natural frequencies and of the gain, and samples of delay more."""


def gives(seed: int, axis: int, design: Design, rig: StageConfig) -> np.ndarray:
    """Return what a force of 100 N moves the plate by at each of `FREQUENCIES`, m."""
    modes = PiezoStagePlant(RATE, seed=seed).modes
    omega, turning = 2 * np.pi * modes.frequency[:, None], 2 * np.pi * FREQUENCIES
    answers = modes.plate[axis][:, None] ** 2 / (omega**2 - turning**2 + 2j * modes.damping[:, None] * omega * turning)
    plant = closed(*linearised(seed, axis, 1.0), pid(rig.inner, axis)).response(FREQUENCIES, RATE)
    loop = design.loop.system().response(FREQUENCIES, RATE) * plant
    return FORCE * np.abs(answers.sum(axis=0) / (1.0 + loop))


def worst_sensitivity(seed: int, axis: int, design: Design, rig: StageConfig) -> float:
    """Return the largest Ms of a loop on the plants themselves, of `OFF`, `GAINS` and `LATER`."""
    controller, found = design.loop.system(), []
    for off, gain in product(OFF, GAINS):
        plant = closed(*linearised(seed, axis, off), pid(rig.inner, axis))
        scaled = StateSpace(plant.A, gain * plant.B, plant.C, gain * plant.D)
        found.append(robustness(scaled, controller, RATE, LATER).max_sensitivity)
    return max(found)


def largest_error(seed: int, axis: int, made: Setup) -> float:
    """Return the largest error of the simulated cut of 100 N along an axis, m, of those of `OFF`."""
    name, found = AXES[axis], []
    force = FORCE / MEAN_FORCES[name][axis]
    for off in OFF:
        options = {**made.config.simulator.options, "seed": seed, "frequency_scale": off, "delay": 1 + LATER}
        cut = {"direction": name, "start": made.config.session.lead, "seconds": SECONDS, "force": force}
        simulator = {"options": options, "surroundings": MILLING, "surroundings_options": cut}
        config = made.config.model_copy(
            update={
                "simulator": made.config.simulator.model_copy(update=simulator),
                "session": made.config.session.model_copy(update={"seconds": SECONDS}),
            }
        )
        each = replace(made, config=config)
        found.append(tracking(error_of(simulated_run(each), each, "wanted", "position")[:, axis]).peak)
    return max(found)


def rows_of(seed: int, axis: int, folder: Path) -> list[list[str]]:
    """Return a row for each of `COMPLIANCE`."""
    rig = rig_file.load(folder / "stage.toml", StageConfig)
    files = [folder / f"stage-{name}.h5" for name in AXES]
    made, rows = setup(rig, files), []
    for compliance in COMPLIANCE:
        outer = rig.outer.model_copy(update={"compliance": compliance})
        found = outer_loop(outer, axis, read_model(files[axis], rate=RATE))
        if isinstance(found, str):
            raise ValueError(f"seed {seed}: {found}")
        designs = list(made.designs)
        designs[axis] = found
        answers = 1e6 * gives(seed, axis, found, rig)
        error = 1e6 * largest_error(seed, axis, replace(made, designs=tuple(designs)))
        figures = [*answers, worst_sensitivity(seed, axis, found, rig), error]
        rows.append([str(seed), AXES[axis], f"{compliance:g}", *(f"{each:.2f}" for each in figures)])
        print(*rows[-1], flush=True)
    return rows


def main() -> None:
    """Print the table, and put it into `docs/`."""
    seeds = [int(text) for text in words()] or SEEDS
    rows = [row for seed in seeds for axis in range(len(AXES)) for row in rows_of(seed, axis, calibrated(seed))]
    answers = ["100 N at 10 Hz, µm", "at 30 Hz, µm"]
    head = ["seed", "axis", "compliance", *answers, "Ms, worst", "cut of 100 N, largest, µm"]
    put(table(head, rows), "stage.md", "compliance")


if __name__ == "__main__":
    main()
