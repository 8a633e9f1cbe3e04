"""Pockets learned on simulated cells, as Table 5.1: what `calibrate milling` and `stagectl ilc` do, seed by seed.

    python -m benchmarks.milling_trials [--seeds 1 2 3 4 5] [--task pocket28] [--methods 1,2,3] [--iterations 4]
        [--set TABLE.KEY=VALUE ...]

Arm, tracker and blocks of a cell are drawn from its seed.  Printed are mean absolute errors' norms, as the tracker sees
them and, in brackets, without its noise.
"""

import argparse
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.on_all_cores import over_seeds
from calibration.milling.session import calibrate
from calibration.milling.sweep_session import sweep
from calibration.output import provenance
from rigkit.config import load
from rigkit.experiment.runner import Conduct
from rigkit.provenance import now
from rigkit.run_folder import RunFolder
from stagectl.experiments.trials.bench import SimulatedBench
from stagectl.experiments.trials.campaign import carried_out, learn_pocket
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.learner import wanted_methods
from stagectl.experiments.trials.runner import Runner
from stagectl.experiments.trials.trial import Trial, cell_for_task
from stagectl.robot.config import CellConfig

HEAD = ("seed", "free space: 0, 1, last", "method", "iteration 0", "1", "last", "reduced by", "worst factor")


def one_seed(
    seed: int, task: str, methods: tuple[int, ...], iterations: int, settings: list[str]
) -> list[tuple[Any, ...]]:
    """Return a row a method: everything that is drawn is drawn from the seed."""
    drawn = [f"{key}.seed={seed}" for key in ("simulator.options", "plants.tracker_options", "plants.pocket_options")]
    cell = cell_for_task(load(None, CellConfig, [*drawn, *settings]), task)
    with tempfile.TemporaryDirectory() as place, RunFolder.create(Path(place) / "run", "") as folder:
        run = Runner(folder, SimulatedBench(), Conduct())
        swept = sweep(cell, False, folder, lambda _: None, Conduct())
        found = calibrate(cell, task, run, swept, provenance(cell, now(), {}))
        learner = Learner(cell, found.models, found.forces, found.free)
        free = ", ".join(_size(each) for each in (*found.free[:2], found.free[-1]))
        rows: list[tuple[Any, ...]] = []
        for method in methods:
            worst = f"{learner.contraction(method).worst:.2f}"
            try:
                done = [found.milled]

                def kept(name: str, trial: Trial, done: list[DoneTrial] = done) -> DoneTrial:
                    done.append(run(name, trial))
                    return done[-1]

                carried_out(learn_pocket(found.milled, learner, method, iterations), kept)
            except ValueError as fault:
                rows.append((seed, free, method, _size(found.milled), "-", "-", str(fault), worst))
                continue
            first, last = (np.linalg.norm(each.mae) for each in (done[0], done[-1]))
            reduced = f"{100 * (1 - last / first):.0f} %"
            rows.append((seed, free, method, *(_size(each) for each in (done[0], done[1], done[-1])), reduced, worst))
    return rows


def _size(done: DoneTrial) -> str:
    true = done.true_mae
    assert true is not None
    return f"{1e6 * np.linalg.norm(done.mae):.0f} ({1e6 * np.linalg.norm(true):.0f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    parser.add_argument("--task", default="pocket28")
    parser.add_argument("--methods", default="1,2,3")
    parser.add_argument("--iterations", type=int, default=4)
    parser.add_argument("--set", action="append", default=[], dest="settings")
    given = parser.parse_args()
    asked = {"task": given.task, "methods": wanted_methods(given.methods), "iterations": given.iterations}
    print(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}")
    for rows in over_seeds(one_seed, given.seeds, **asked, settings=given.settings):
        for row in rows:
            print(f"| {' | '.join(map(str, row))} |", flush=True)


if __name__ == "__main__":
    main()
