"""Table 3.1: the integrated absolute error of steps, of the other controllers over that of the adaptive one."""

from typing import Any

import numpy as np

from stagectl.experiments.midranging.measures import iae
from stagectl.experiments.midranging.scenario import STEPS, Scenario, steps
from stagectl.experiments.midranging.schedule import simulate
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging_config import MidrangeConfig

ROWS = (("sim, r = 1.5", 1.5e-3, 0.0), ("sim, r = 5", 5e-3, 0.0), ("sim, r = 5, noise", 5e-3, 0.05e-3))
"""Name, m, and m of noise on each sensor: the first three rows."""
COMPARED = ("aimc", "mvpc-aw", "mvpc")
SEEDS = 5
MILLIMETRE = 1e-3


def table(config: MidrangeConfig, seeds: int = SEEDS) -> list[dict[str, Any]]:
    """Run the simulated rows of Table 3.1.

    Parameters
    ----------
    config : MidrangeConfig
        Its `learning.noise` is that of the row where that has any.
    seeds : int, >= 1
        Over how many runs a row with noise is averaged.

    Returns
    -------
    list of dict
        For each row `setup`, `mvpc_aw` and `mvpc` (1), `aimc_iae` (mm s a step, as in the thesis), and the smallest and
        largest of either ratio over the runs.

    Source
    ------
    Sörnmo 2015, table 3.1 and eq. (3.15).

    Departs
    -------
    Where there is noise, the error is that of the position itself and not of what is measured.
    """
    rows = []
    for setup, size, noise in ROWS:
        errors = np.array([_errors(config, size, noise, seed) for seed in range(1, seeds + 1 if noise else 2)])
        ratios = errors[:, 1:] / errors[:, :1]
        mean = errors.mean(axis=0)
        rows.append(
            {
                "setup": setup,
                "mvpc_aw": mean[1] / mean[0],
                "mvpc": mean[2] / mean[0],
                "aimc_iae": mean[0] / MILLIMETRE,
                "mvpc_aw_range": [ratios[:, 0].min(), ratios[:, 0].max()],
                "mvpc_range": [ratios[:, 1].min(), ratios[:, 1].max()],
                "runs": len(errors),
            }
        )
    return rows


def _errors(config: MidrangeConfig, size: float, noise: float, seed: int) -> list[float]:
    """Return the mean error of a step with each of `COMPARED`, m s."""
    if noise:
        learning = config.learning.model_copy(update={"noise": noise})
        config = config.model_copy(update={"learning": learning})
    options = {"noise": noise, "seed": seed} if noise else {}
    chosen = Scenario("steps", steps(size, config.pair.rate), options)
    return [iae(simulate(controller(name, config), chosen, config)) / STEPS for name in COMPARED]
