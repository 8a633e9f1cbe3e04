"""Learning to mill by models that are wrong, on drawn cells: what is refused, and whether a trial made the work worse.

    python -m benchmarks.wrong_models [--seeds 6000 6001 ...] [--methods 1 2] [--set TABLE.KEY=VALUE ...]

A small pocket, two iterations.  A row a model: of how many runs it was refused before a learned path was milled, and
the worst trial beside the one that was not compensated.
"""

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import table
from calibration.milling.session import Calibrated, calibrate
from calibration.milling.sweep_session import sweep
from firmware_sim.population.cell_population import CELLS
from rigkit import config as rig_file
from rigkit.experiment.runner import Conduct
from rigkit.run_folder import RunFolder
from rigkit.toml_text import value_text
from stagectl.experiments.trials.bench import SimulatedBench
from stagectl.experiments.trials.campaign import carried_out, learn
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.lookback import size
from stagectl.experiments.trials.runner import Runner
from stagectl.experiments.trials.trial import Trial, cell_for_task, first_trial
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.milling_models import MillingModels

SMALL = (
    "pocket.size=[20e-3, 20e-3]", "pocket.depth=1e-3", "pocket.clearance=3e-4", "pocket.lead=1.0", "pocket.tail=0.5",
    "pocket.workpiece=[30e-3, 30e-3, 5e-3]", "learning.free=1",
)  # fmt: skip
WRONG = {
    "right": (1.0, 1.0, 1.0),
    "G_R x 2": (2.0, 1.0, 1.0), "G_R x 3": (3.0, 1.0, 1.0), "G_R / 2": (0.5, 1.0, 1.0), "G_R / 3": (1 / 3, 1.0, 1.0),
    "G_K x 2": (1.0, 2.0, 1.0), "G_K x 3": (1.0, 3.0, 1.0), "G_K / 2": (1.0, 0.5, 1.0), "G_K / 3": (1.0, 1 / 3, 1.0),
    "G_K turned round": (1.0, -1.0, 1.0), "G_M x 3": (1.0, 1.0, 3.0), "G_M turned round": (1.0, 1.0, -1.0),
}  # fmt: skip
"""Factors of G_R, G_K and G_M."""
ITERATIONS = 2


@dataclass(frozen=True)
class Outcome:
    """One run.

    Parameters
    ----------
    model : str, of `WRONG`
    method : int
    refused : str
        Why, or nothing.
    sizes : tuple of float, m
        Norms of the errors of the trials in material.
    """

    model: str
    method: int
    refused: str
    sizes: tuple[float, ...]


def scaled(models: MillingModels, robot: float, compliance: float, force: float) -> MillingModels:
    """Return models whose G_R, G_K and G_M are so many times as large."""
    sides = {
        side: replace(
            each,
            axes=tuple(replace(axis, numerator=robot * np.asarray(axis.numerator)) for axis in each.axes),
            response=robot * each.response,
        )
        for side, each in models.robot.items()
    }
    processes = {}
    for name, each in models.process.items():
        bends, cuts = each.model.compliance, each.model.force
        changed = replace(
            each.model,
            compliance=replace(bends, C=compliance * bends.C, D=compliance * bends.D),
            force=replace(cuts, C=force * cuts.C, D=force * cuts.D),
        )
        processes[name] = replace(each, model=changed, other=compliance * force * each.other)
    return replace(models, robot=sides, process=processes)


def one_seed(seed: int, models: Sequence[str], methods: Sequence[int], settings: Sequence[str]) -> list[Outcome]:
    """Return what came of models and methods on a drawn cell, and print it; nothing of one that is not calibrated."""
    try:
        found = _one_seed(seed, models, methods, settings)
    except ValueError as fault:
        print(f"{seed} is not calibrated: {fault}", flush=True)
        return []
    for each in found:
        sizes = ", ".join(f"{1e6 * one:.0f}" for one in each.sizes)
        print(f"{seed} {each.model}, method {each.method}: {sizes} {each.refused[:120]}", flush=True)
    return found


def _one_seed(seed: int, models: Sequence[str], methods: Sequence[int], settings: Sequence[str]) -> list[Outcome]:
    drawn = [f"{key}={value_text(value)}" for key, value in CELLS.draw(seed).keys.items()]
    cell = cell_for_task(rig_file.load(None, CellConfig, [*drawn, *SMALL, *settings]), "pocket")
    with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "raw", "") as folder:
        swept = sweep(cell, False, folder, lambda _: None, Conduct())
        found = calibrate(cell, "pocket", Runner(folder, SimulatedBench(), Conduct()), swept, {})
    return [_run(cell, found, model, method) for model in models for method in methods]


def _run(cell: CellConfig, found: Calibrated, model: str, method: int) -> Outcome:
    sizes: list[float] = []
    with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "run", "") as folder:
        run = Runner(folder, SimulatedBench(), Conduct())

        def kept(name: str, trial: Trial) -> DoneTrial:
            done = run(name, trial)
            if trial.is_milled:
                sizes.append(size(done))
            return done

        learner = Learner(cell, scaled(found.models, *WRONG[model]), found.forces)
        try:
            carried_out(learn(first_trial(cell, "pocket"), learner, [method], ITERATIONS), kept)
        except ValueError as fault:
            return Outcome(model, method, str(fault), tuple(sizes))
    return Outcome(model, method, "", tuple(sizes))


def main() -> None:
    """Run all, and print a row a model and method."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(6000, 6006)))
    parser.add_argument("--models", nargs="+", choices=WRONG, default=list(WRONG))
    parser.add_argument("--methods", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--set", action="append", default=[], dest="settings")
    given = parser.parse_args()
    asked = {"models": given.models, "methods": given.methods, "settings": given.settings}
    found = [each for rows in over_seeds(one_seed, given.seeds, **asked) for each in rows]
    head = (
        "model",
        "method",
        "runs",
        "refused before a learned path",
        "reduced by, median",
        "worst trial over the first",
    )
    print(table(head, [_row(found, model, method) for model in given.models for method in given.methods]))


def _row(found: Sequence[Outcome], model: str, method: int) -> tuple[str, ...]:
    runs = [each for each in found if (each.model, each.method) == (model, method)]
    learned = [each for each in runs if len(each.sizes) > 1]
    refused = sum(bool(each.refused) and len(each.sizes) < 2 for each in runs)
    reduced = (
        f"{100 * (1 - np.median([min(each.sizes) / each.sizes[0] for each in learned])):.0f} %" if learned else "-"
    )
    worst = f"{max(max(each.sizes[1:]) / each.sizes[0] for each in learned):.2f}" if learned else "-"
    return model, f"{method}", f"{len(runs)}", f"{refused}", reduced, worst


if __name__ == "__main__":
    main()
