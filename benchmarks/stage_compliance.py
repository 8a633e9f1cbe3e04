"""How far a cut of 100 N pushes the plate: outer loops calibrated with `outer.compliance` and without, side by side.

`python -m benchmarks.stage_compliance [SEED ...] [--write]`, two minutes a seed, on the chirps that
`benchmarks.stage_chain` has recorded, models and loops made as `calibrate stage` does.  Answers at 10 and 30 Hz and
Ms are those of the plants themselves, linearised, all modes among them, the inner loop closed.  Ms is the largest where
natural frequencies are off by 5 % either way, the gain by 20 % either way, and there is one sample of delay more.  The
cut is the simulated one, nonlinear, its force scaled to a mean of 100 N along the axis; the largest error is that of
the worst of natural frequencies off by 5 % or not, one sample of delay more.  Nothing else moves the plate.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
from scipy.linalg import expm

from benchmarks.page_table import put, table, words
from benchmarks.stage_chain import AXES, RATE, SECONDS, SEEDS, calibrated, simulated_run
from benchmarks.stage_robustness import closed, linearised
from calibration.experiment import RawFolder
from calibration.stage_axes.allowed import quiet_above
from calibration.stage_axes.bench import RecordedBench
from calibration.stage_axes.calibration import AxisCalibration, calibrate_axes
from firmware_sim.plants.milling_disturbance import MillingDisturbance
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.experiments.piezo.figures import error_of
from stagectl.experiments.piezo.scenario import MILLING
from stagectl.experiments.piezo.setup import Setup, setup
from stagectl.stage.design import Design
from stagectl.stage.design_refinement import designed
from stagectl.stage.piezo_pid import pid
from stagectl.stage.sensitivity import robustness
from stagectl.stage.state_space import StateSpace
from stagectl.tracking import tracking

COMPLIANCE = 0.0, 1.0
"""Of `outer.compliance`; the first is the default."""
FORCE = 100.0
"""N, mean along the cut."""
FREQUENCIES = np.array([10.0, 30.0])
OFF, GAINS, LATER = (0.95, 1.0, 1.05), (0.8, 1.0, 1.2), 1
"""Factors of natural frequencies and of the gain, and samples of delay more."""


def pushed(seed: int, axis: int, rig: StageConfig) -> StateSpace:
    """Return an axis from the force on its plate (N) to its position (m), the inner loop closed, its reference held."""
    stack, position = linearised(seed, axis, 1.0)
    modes, control = PiezoStagePlant(RATE, seed=seed).modes, pid(rig.inner, axis).system(RATE)
    starts = []
    for omega, damping, shape in zip(2 * np.pi * modes.frequency, modes.damping, modes.plate[axis], strict=True):
        drift, drive = np.array([[0.0, omega], [-omega, -2 * damping * omega]]), np.array([[0.0], [shape]])
        starts.append(expm(np.block([[drift, drive], [np.zeros((1, 3))]]) / RATE)[:2, 2:])
    rest = len(stack.A) + len(control.A) - 2 * len(starts)
    whole = closed(stack, position, pid(rig.inner, axis))
    return StateSpace(whole.A, np.vstack([*starts, np.zeros((rest, 1))]), whole.C, whole.D)


def gives(seed: int, axis: int, design: Design, rig: StageConfig) -> np.ndarray:
    """Return what a force of 100 N moves the plate by at each of `FREQUENCIES`, m."""
    plant = closed(*linearised(seed, axis, 1.0), pid(rig.inner, axis)).response(FREQUENCIES, RATE)
    loop = design.loop.system().response(FREQUENCIES, RATE) * plant
    return FORCE * np.abs(pushed(seed, axis, rig).response(FREQUENCIES, RATE) / (1.0 + loop))


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
    name, found, start = AXES[axis], [], made.config.session.lead
    force = FORCE / mean_force(name, axis, start)
    for off in OFF:
        options = {**made.config.simulator.options, "seed": seed, "frequency_scale": off, "delay": 1 + LATER}
        cut = {"direction": name, "start": start, "seconds": SECONDS, "force": force}
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


def mean_force(name: str, axis: int, start: float) -> float:
    """Return the mean force of the cut as it is drawn, N, while it lasts."""
    whole = MillingDisturbance(RATE, direction=name, start=start, seconds=SECONDS)
    force, base = np.zeros((2, round((start + SECONDS) * RATE), 3))
    whole.run(force, base)
    return float(force[whole.cut, axis].mean())


def calibrations(seed: int) -> list[AxisCalibration]:
    """Identify a stage again from its chirps, with its outer loops."""
    folder = calibrated(seed)
    rig = rig_file.load(None, StageConfig, [f"simulator.options.seed={seed}"])
    with RawFolder(folder / "stage.raw") as raw:
        return calibrate_axes(rig, range(len(AXES)), raw, None, "moesp", partial(RecordedBench, rig), {})


def rows_of(seed: int) -> list[list[str]]:
    """Return a row for each axis and each of `COMPLIANCE`."""
    folder, found, rows = calibrated(seed), calibrations(seed), []
    rig = rig_file.load(folder / "stage.toml", StageConfig)
    before = setup(rig, [folder / f"stage-{name}.h5" for name in AXES])
    for axis, compliance in product(range(len(AXES)), COMPLIANCE):
        outer, closed = rig.outer.model_copy(update={"compliance": compliance, "allowed": ()}), found[axis].closed
        model = closed.one.model
        made = designed(model, outer, axis, quiet_above(outer, axis, model, closed.above, closed.seen))
        designs = [made if at == axis else each for at, each in enumerate(before.designs)]
        error = 1e6 * largest_error(seed, axis, replace(before, designs=tuple(designs)))
        figures = [*(1e6 * gives(seed, axis, made, rig)), worst_sensitivity(seed, axis, made, rig), error]
        rows.append([str(seed), AXES[axis], f"{compliance:g}", *(f"{each:.2f}" for each in figures)])
        print(*rows[-1], flush=True)
    return rows


def main() -> None:
    """Print the table, and put it into `docs/`."""
    seeds = [int(text) for text in words()] or SEEDS
    rows = [row for seed in seeds for row in rows_of(seed)]
    answers = ["100 N at 10 Hz, µm", "at 30 Hz, µm"]
    head = ["seed", "axis", "compliance", *answers, "Ms, worst", "cut of 100 N, largest, µm"]
    put(table(head, rows), "validation/stage.md", "compliance")


if __name__ == "__main__":
    main()
