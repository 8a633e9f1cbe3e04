"""Mid-ranging beside python-control's simulation of the same loops, and beside a controller in plain numpy."""

from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np

from benchmarks.test_midranging_speed import calls
from rigkit import config as rig_file
from stagectl.experiments.midranging.measures import channel, iae
from stagectl.experiments.midranging.scenario import Scenario
from stagectl.experiments.midranging.schedule import lead_of, simulate
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging.tuning import LoopModel
from stagectl.robot.midranging_config import MidrangeConfig

SIZE, SECONDS = 1.5e-3, 60.0
"""m, of a step that saturates nothing, and s: long enough to time."""
HEAD = ("what", "ours", "peer", "peer over ours")


def rows() -> list[list[str]]:
    """Return what was compared."""
    compiled, numpy = calls()
    told = [[
        "AIMC, order 3: a call of one sample",
        f"{1e6 * compiled:.1f} µs",
        f"numpy, the same equations: {1e6 * numpy:.0f} µs",
        f"{numpy / compiled:.0f}",
    ]]  # fmt: skip
    if find_spec("control") is None:
        return [*told, ["MVPC, a step of 60 s", "", "python-control: not installed", ""]]
    return told + _beside_control()


def _beside_control() -> list[list[str]]:
    config = rig_file.load(None, MidrangeConfig, [])
    chosen = Scenario("step", np.full(round(SECONDS * config.pair.rate), SIZE))
    simulate(controller("mvpc", config), chosen, config)
    begun = process_time()
    ours = simulate(controller("mvpc", config), chosen, config)
    spent = process_time() - begun
    theirs, peer = _by_control(config, len(chosen.reference))
    position = channel(ours, "position")
    apart = float(np.abs(position - theirs).max() / SIZE)
    errors = [iae(ours), float(np.abs(SIZE - theirs).sum() / config.pair.rate)]
    samples = lead_of(config) + len(position)
    return [
        ["MVPC, a step: largest difference of the position, of the step", f"{apart:.1e}", "python-control", ""],
        ["the same: IAE", f"{1e6 * errors[0]:.4g} µm s", f"{1e6 * errors[1]:.4g} µm s", f"{errors[1] / errors[0]:.4f}"],
        [
            "the same: a sample (ours with blocks, guards and recording)",
            f"{1e6 * spent / samples:.2f} µs",
            f"`forced_response`: {1e6 * peer / len(position):.2f} µs",
            f"{peer / len(position) / (spent / samples):.2f}",
        ],
    ]


def _by_control(config: MidrangeConfig, samples: int) -> tuple[np.ndarray, float]:
    """Return the position, shape (samples,), m, by python-control, and the seconds it took."""
    import control

    step = 1.0 / config.pair.rate
    fast, slow = (_transfer(_loop(config, name), step) for name in ("fast", "slow"))
    times = [_loop(config, name).time_constant(config.pair.rate) for name in ("fast", "slow")]
    first, second = (control.TransferFunction([1.0, step / time - 1.0], [1.0, -1.0], step) for time in times)
    closed = control.feedback(first * (fast + slow * second), 1)
    system, time = control.ss(control.minreal(closed, verbose=False)), np.arange(samples) * step
    wanted = np.full(samples, SIZE)
    begun = process_time()
    position: np.ndarray = control.forced_response(system, time, wanted).outputs
    return position, process_time() - begun


def _loop(config: MidrangeConfig, name: str) -> LoopModel:
    return LoopModel(getattr(config.pair, f"{name}_outputs"), getattr(config.pair, f"{name}_inputs"))


def _transfer(model: LoopModel, step: float) -> Any:
    import control

    return control.TransferFunction(list(model.inputs), [1.0, *(-a for a in model.outputs)], step)
