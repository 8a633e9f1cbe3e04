"""Force control by the feed: the tables of docs/validation/force.md.

`python -m benchmarks.force_control [figure] [gains] [stiffness] [oak] [planners]`, all by default; minutes.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.page_table import put, table, words
from calibration.state_space.model import InnovationModel
from calibration.subspace.identify import identify
from firmware_sim.plants.feed_process import FeedProcess
from rigkit.experiment.runner import Conduct
from rigkit.experiment.succession import run_in_memory
from stagectl.experiments.feed.job import Job, pocket_of
from stagectl.experiments.feed.pockets import Pockets
from stagectl.experiments.feed.process_run import channel, process_figures, run_process, simulated
from stagectl.experiments.feed.read_back import velocity_model
from stagectl.robot.config import CellConfig
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_record import CONTROLLING

PLANT = "firmware_sim.feed_blocks:FedTool"
SEEDS, PIECES = range(1, 6), range(1, 41)
"""Of fig. 7.5, and pieces of wood: as many of them as of `SEEDS` have a line."""
KAPPAS = (0.1, 0.2, 0.4, 0.7, 1.0, 2.0, 4.0)
"""mm/(N s)."""
STILL = {"kappa_swing": 0.0, "beta_swing": 0.0, "beta_step": 0.0}


def identified() -> InnovationModel:
    """Return the process' velocity dynamics of order 3 by N4SID, from 16 s of steps of the feed in free space."""
    plant, rng = FeedProcess(250.0, kappa=0.1, kappa_swing=0.0), np.random.default_rng(7)
    asked = np.repeat(0.02 + 0.01 * rng.choice([-1.0, 1.0], 400), 10)[:, None]
    seen = [np.zeros((len(asked), width)) for width in (1, 2, 2, 1, 1)]
    plant.run(asked, *seen)
    return identify(asked[50:], seen[0][50:], rate=250.0, order=3, direct=False, delay=0).model


def figure() -> None:
    """Run fig. 7.5 with both starts."""
    rows, model = [], identified()
    for start in ("gentle", "constant"):
        found = [
            process_figures(run_process(ForceFeed(start=start), model, simulated(PLANT, {"seed": seed})), 10.0)
            for seed in SEEDS
        ]
        worst: dict[str, float] = {key: max(abs(each[key]) for each in found) for key in found[0]}
        rows.append([start, *(f"{worst[key]:.3g}" for key in ("activation", "force_before", "settled_after")),
                     *(f"{worst[key]:.3g}" for key in ("mean_error", "largest_error")),
                     f"{1e3 * worst['kappa_error']:.2g}", f"{worst['beta_error']:.2g}"])  # fmt: skip
    head = ["start", "control begins, s", "largest force until then, N", "settled to 5 %, s", "mean error, N",
            "largest error, N", "κ, rms, mm/(N s)", "β, rms"]  # fmt: skip
    put(table(head, rows), "validation/force.md", "figure")


def gains() -> None:
    """Compare gains that follow kappa with those of the first guess, 0.4 mm/(N s), over kappa."""
    rows, model = [], identified()
    for kappa in KAPPAS:
        cells = [f"{kappa:g}"]
        for adapted in (True, False):
            options = STILL | {"kappa": 1e-3 * kappa, "kappa_step": 0.25e-3 * kappa}
            record = run_process(ForceFeed(adapted=adapted), model, simulated(PLANT, options))
            found = process_figures(record, 10.0)
            force = np.hypot(channel(record, "true_force_1"), channel(record, "true_force_2"))
            begun = int(np.argmax(channel(record, "phase") == CONTROLLING))
            ringing = float(force[begun + 500 : 1500].std())
            settled = "never" if np.abs(force[1400:1500] - 10.0).max() > 0.5 else f"{found['settled_after']:.2f}"
            cells += [settled, f"{force[begun + 25 : 1500].max():.1f}", f"{ringing:.2f}"]
        rows.append(cells)
    parts = ("settled to 5 %, s", "largest, N", "σ, N")
    head = ["κ, mm/(N s)", *(f"{part}: {kind}" for kind in ("adapted", "fixed") for part in parts)]
    put(table(head, rows), "validation/force.md", "gains")


def stiffness() -> None:
    """Tell the controller another K_f than there is."""
    rows, model = [], identified()
    for share in (2 / 3, 1.0, 4 / 3):
        settings = ForceFeed(stiffness=75e3 * share)
        found = process_figures(run_process(settings, model, simulated(PLANT, {})), 10.0)
        rows.append([f"{share:.2f}", f"{found['settled_after']:.2f}", f"{found['mean_error']:.3f}",
                     f"{found['largest_error']:.2f}", f"{1e3 * found['kappa_error']:.3f}"])  # fmt: skip
    head = ["K_f believed over true", "settled to 5 %, s", "mean error, N", "largest error, N", "κ, rms, mm/(N s)"]
    put(table(head, rows), "validation/force.md", "stiffness")


def oak() -> None:
    """Mill pockets in oak by force control, and again by position control at the safe feed."""
    rows: list[list[Any]] = []
    saved = []
    for seed in PIECES:
        found = _milled(seed, Job("pocket", compares=True))
        force, position = found["pockets"]
        saved.append(found["saved"])
        rows.append([seed, f"{force['seconds']:.1f}", f"{position['seconds']:.1f}", f"{100 * found['saved']:.1f}",
                     f"{force['force_mean']:.2f}", f"{force['force_deviation']:.2f}", f"{force['force_peak']:.1f}",
                     f"{position['force_mean']:.2f}", f"{position['force_peak']:.1f}"])  # fmt: skip
        print(rows[-1], flush=True)
    head = ["piece", "force control, s", "position control, s", "saved, %", "force, N", "σ, N", "largest, N",
            "position control: force, N", "largest, N"]  # fmt: skip
    put(table(head, rows[: len(SEEDS)]), "validation/force.md", "oak")
    distribution(saved)


def distribution(saved: list[float]) -> None:
    """Put what was saved on each piece, 1, and how it is spread, into their tables."""
    rng, percent = np.random.default_rng(1), 100.0 * np.array(saved)
    again = np.median(rng.choice(percent, (10_000, len(percent))), axis=1)
    told = [f"{each:.1f}" for each in (np.median(percent), percent.mean(), percent.min(), percent.max())]
    told += [f"{low:.1f} to {high:.1f}" for low, high in (np.quantile(again, [0.025, 0.975]),
                                                         np.quantile(percent, [0.1, 0.9]))]  # fmt: skip
    head = ["pieces", "median, %", "mean, %", "least, %", "most, %", "median, 95 % interval", "10th to 90th percentile"]
    put(table(head, [[len(saved), *told]]), "validation/force.md", "saved")
    lines = [percent[n : n + 10] for n in range(0, len(percent), 10)]
    rows = [
        [f"{10 * n + 1} to {10 * n + len(line)}", *(f"{each:.1f}" for each in line)] for n, line in enumerate(lines)
    ]
    put(table(["pieces, saved, %", *[""] * 10], rows), "validation/force.md", "pieces")


def planners() -> None:
    """Mill three pockets one after the other: a planner that knows what was published, and ones that know nothing."""
    rows = []
    for name, is_untrained in (("sequential", False), ("sequential", True), ("uncertain", True)):
        found = _milled(1, Job("pocket", planner=name, is_untrained=is_untrained, pockets=3))["pockets"]
        known = "nothing known" if is_untrained else "published rates"
        rows.append([f"{name}, {known}", *(f"{each['seconds']:.1f}" for each in found)])
    put(table(["planner", "pocket 1, s", "pocket 2, s", "pocket 3, s"], rows), "validation/force.md", "planners")


def _milled(seed: int, job: Job) -> dict[str, Any]:
    cell = CellConfig()
    plants = cell.feed_plants.model_copy(update={"cut_options": {"seed": seed}})
    cell = cell.model_copy(update={"feed_plants": plants})
    pocket = pocket_of(job.task, cell.segments)
    assert pocket is not None
    experiment = Pockets(cell, replace(job, pocket=pocket), velocity_model(None))
    _, records = run_in_memory(experiment.parts(), Conduct())
    return experiment.figures(records)


PARTS: dict[str, Callable[[], Any]] = {
    "figure": figure,
    "gains": gains,
    "stiffness": stiffness,
    "oak": oak,
    "planners": planners,
}

if __name__ == "__main__":
    for part in words() or PARTS:
        PARTS[part]()
