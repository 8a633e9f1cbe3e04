"""From `calibrate stage` to a milled part, on several simulated stages.

`python -m benchmarks.stage_chain [SEED ...] [--hand-made] [--write]`, three minutes a seed.  Calibrates every axis as
`calibrate stage --axis all --seed SEED` does, into `FOLDER` (a stage that is there is not calibrated again), then mills
against each axis with the rig file and the models that this gives.  With `--hand-made` no stage is calibrated: models
are made of the plants' own modes, and the outer loops chosen for them as that command does.  Prints a line a run and
then the table, `--write` puts it into `docs/`.
"""

import math
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from json import loads
from pathlib import Path

import numpy as np

from benchmarks.page_table import put, table, words
from calibration.stage_axes.calibration import outer_loop
from ctlblocks.recording import Recording
from firmware_sim.plants.milling_disturbance import MillingDisturbance
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from firmware_sim.plants.piezo_stage_modes import MAIN_BAND
from rigkit import config as rig_file
from rigkit.experiment.runner import Conduct, remembered
from stagectl.config import ChosenWeights, StageConfig
from stagectl.experiments.piezo.cell import RECORDING
from stagectl.experiments.piezo.experiment import StageRun
from stagectl.experiments.piezo.figures import error_of
from stagectl.experiments.piezo.scenario import scenario_settings
from stagectl.experiments.piezo.setup import Setup, setup
from stagectl.models.model_file import write_model
from stagectl.tracking import Tracking, tracking
from tests.stagectl.experiments.piezo.linear_stage import lagging, sampled
from tests.stagectl.experiments.piezo.simulated_models import LAG

FOLDER = Path("runs/stage-chain")
SEEDS, HAND_MADE_SEEDS = range(1, 6), range(1, 21)
SECONDS = 8.0
"""Of each cut."""
RATE, AXES = 10_000.0, ("x", "y", "z")
SHARE = 0.03
"""Of an axis' gain at rest: modes that have less are flexure."""
MOST_MAE, MOST_ERROR = 2e-6, 5e-6
"""m: what a run passes with."""


@dataclass(frozen=True)
class Cut:
    """A cut that was compensated: its error, and the mean absolute deflection of the robot, m."""

    error: Tracking
    deflection: float
    sensitivity: float

    @property
    def passes(self) -> bool:
        """Whether mean and largest error are as small as they are to be."""
        return self.error.mae < MOST_MAE and self.error.peak <= MOST_ERROR

    def __str__(self) -> str:
        """Say it as cells of a table."""
        better = self.deflection / self.error.mae
        return (
            f"{1e6 * self.error.mae:.2f} | {1e6 * self.error.peak:.1f} | {100 * self.error.within:.2f} | {better:.0f}"
        )


def calibrated(seed: int) -> Path:
    """Calibrate a stage, unless it is; return the folder."""
    folder = FOLDER / f"seed-{seed}"
    if not (folder / "stage.json").exists():
        folder.mkdir(parents=True, exist_ok=True)
        options = ("--axis", "all", "--seed", str(seed), "--out", folder / "stage.h5", "--json", folder / "stage.json")
        subprocess.run([sys.executable, "-m", "calibration", "stage", *map(str, options)], check=False)
    return folder


def hand_made(seed: int, folder: Path) -> list[Path]:
    """Write models of a plant's main modes and a lag for the rest, and a rig file; return the models' files."""
    files, chosen = [], []
    for axis, name in enumerate(AXES):
        frequency, damping, gain, extension = true_modes(seed, axis)
        main = [tuple(map(float, row)) for row in zip(frequency, damping, gain / extension, strict=True)]
        files.append(folder / f"{name}.h5")
        model = lagging(sampled(main), LAG)  # type: ignore[arg-type]  # rows of three
        write_model(files[-1], model)
        found = outer_loop(StageConfig().outer, axis, model)
        if isinstance(found, str):
            raise ValueError(f"seed {seed}: {found}")
        chosen.append(found.weights)
    weights = {key: tuple(getattr(each, key) for each in chosen) for key in ChosenWeights.model_fields}
    rig = StageConfig(weights=ChosenWeights(**weights))
    (folder / "stage.toml").write_text(rig_file.dump(rig), encoding="utf-8")
    return files


def true_modes(seed: int, axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return frequency (Hz), damping and gain of an axis' main modes, and the extension's gain, in one unit."""
    modes = PiezoStagePlant(RATE, seed=seed).modes
    gain = modes.plate[axis] * modes.extension[axis] / modes.frequency**2
    main = (modes.frequency < MAIN_BAND) & (np.abs(gain) > SHARE * abs(gain.sum()))
    stretched = float((modes.extension[axis] ** 2 / modes.frequency**2).sum())
    return modes.frequency[main], modes.damping[main], gain[main], stretched


def cut(axis: int, seed: int, files: Sequence[Path]) -> Cut:
    """Mill against an axis, compensated, by the rig file beside the models."""
    name, config = AXES[axis], files[0].parent / "stage.toml"
    given = [f"simulator.options.seed={seed}", f"session.seconds={SECONDS}", "session.compare=false"]
    session = rig_file.load(config, StageConfig, given).session
    made = setup(rig_file.load(config, StageConfig, [*scenario_settings(f"milling-{name}", session), *given]), files)
    error = error_of(simulated_run(made), made, "wanted", "absolute")[:, axis]
    base = np.zeros((round((session.lead + SECONDS) * RATE), 3))
    whole = MillingDisturbance(RATE, direction=name, start=session.lead, seconds=SECONDS)
    whole.run(np.zeros_like(base), base)
    return Cut(
        tracking(error),
        float(np.abs(base[whole.cut, axis]).mean()),
        made.designs[axis].robustness.max_sensitivity,
    )


def simulated_run(made: Setup) -> Recording:
    """Run a simulated stage to its end, its deflection compensated where the rig file says so; return all signals."""
    *_, part = StageRun(made).parts()
    records, ended = remembered(part, Conduct())
    if ended.reason:
        raise ValueError(f"{made.config.simulator.options}: {ended.reason}")
    return records[RECORDING]


def rows_of(seed: int) -> Iterator[tuple[list[str], bool]]:
    """Return a row for each axis of a calibrated stage, and whether it passes."""
    folder = calibrated(seed)
    found = loads((folder / "stage.json").read_text(encoding="utf-8"))
    files = [folder / f"stage-{name}.h5" for name in AXES]
    for axis, name in enumerate(AXES):
        model = found[name]["closed"]
        fit = model["held_back"]["outputs"][f"position_{name}"]["free_run_nrmse"]
        modes = [each["frequency_hz"] for each in model["modes"] if abs(each["damping_ratio"]) < 1]
        off = max(min(abs(mode / true - 1) for mode in modes) for true in true_modes(seed, axis)[0])
        milled = cut(axis, seed, files)
        orders = f"{model['order']} | {found[name]['closed_all']['order']}"
        row = [str(seed), name, orders, f"{fit:.1f}", f"{100 * off:.2f}", f"{milled.sensitivity:.2f}", str(milled)]
        yield row, milled.passes


def main() -> None:
    """Run every seed, and print the table."""
    given = words()
    by_hand = "--hand-made" in given
    seeds = [int(text) for text in given if text.isdigit()] or list(HAND_MADE_SEEDS if by_hand else SEEDS)
    rows, passed = [], 0
    for seed in seeds:
        if by_hand:
            with tempfile.TemporaryDirectory() as folder:
                files = hand_made(seed, Path(folder))
                cuts = [cut(axis, seed, files) for axis in range(len(AXES))]
            lines = [([str(seed), name, str(each)], each.passes) for name, each in zip(AXES, cuts, strict=True)]
        else:
            lines = list(rows_of(seed))
        for row, passes in lines:
            print(*row, "passes" if passes else "", flush=True)
            rows.append(row)
            passed += passes
    errors = ["MAE, µm", "largest, µm", "within 5 µm, %", "times better"]
    found = ["order", "of all positions", "free run, %", "modes off by, %", "Ms"]
    if by_hand:
        put(table(["seed", "axis", *errors], rows), "validation/stage.md", "hand-made")
    else:
        put(table(["seed", "axis", *found, *errors], rows), "validation/stage.md", "chain")
    print(f"{passed} of {math.prod((len(seeds), len(AXES)))} pass")


if __name__ == "__main__":
    main()
