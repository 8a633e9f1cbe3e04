"""Figures of merit of a mid-ranging run."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.midranging.scenario import Scenario
from stagectl.experiments.midranging.schedule import simulate
from stagectl.robot.midranging.axis_record import TAKEN_OVER
from stagectl.robot.midranging.controllers import fast_loop, known_pair
from stagectl.robot.midranging.internal_model import InternalModel
from stagectl.robot.midranging_config import MidrangeConfig


def channel(run: Recording, name: str) -> np.ndarray:
    """Return one channel of a run, shape (samples,), in its own unit."""
    return run.select([name]).data[:, 0]


def together(runs: Mapping[str, Recording], name: str) -> list[np.ndarray]:
    """Return one channel of each axis, shape (samples,), as far as all of them are recorded.

    Parameters
    ----------
    runs : mapping of str to Recording
    name : str
    """
    samples = min(len(run.data) for run in runs.values())
    return [channel(run, name)[:samples] for run in runs.values()]


def iae(run: Recording) -> float:
    """Return the integrated absolute error of the relative position itself, m s [Sörnmo 2015, eq. (3.15)]."""
    return float(np.abs(channel(run, "reference") - channel(run, "position")).sum() / run.rate)


def figures(run: Recording, chosen: Scenario, config: MidrangeConfig) -> dict[str, Any]:
    """Return what a run comes to: errors in m, the control signal over its limit, and the fast position in m."""
    control, fast = np.abs(channel(run, "control")), channel(run, "fast") - config.pair.middle
    found: dict[str, Any] = {
        "seconds": len(run.data) / run.rate,
        "iae": iae(run),
        "largest_control": float(control.max()),
        "control_over_limit": float(control.max() / config.inner.limit),
        "saturated_share": float(np.mean(control >= config.inner.limit * (1.0 - 1e-9))),
        "fast_rms": float(np.sqrt(np.mean(fast**2))),
        "fast_peak": float(np.abs(fast).max()),
    }
    if "share" in run.names:
        last = run.data[-1]
        found["taken_over_at"] = taken_over_at(run)
        found["governed_share"] = float(np.mean(channel(run, "share") < 1.0))
        for loop in ("fast", "slow"):
            found[f"{loop}_model"] = last[model_columns(run, loop)].tolist()
        if chosen.gains:
            found["changes"] = changes(run, chosen, config)
    return found


def taken_over_at(run: Recording) -> float | None:
    """Return when valve position control took over, s from the reference's first sample (0: before it); else None."""
    if "active" not in run.names:
        return None
    taken = np.flatnonzero(channel(run, "active") == TAKEN_OVER)
    return float(taken[0] / run.rate) if len(taken) else None


def changes(run: Recording, chosen: Scenario, config: MidrangeConfig) -> list[dict[str, float]]:
    """Say how well a run of adaptive control came through each change of the process gain that it lasted beyond.

    Returns
    -------
    list of dict
        For each change `time` (s) and `gain`; `deviation`: the largest distance, one period after it and until the
        next, from the same controller with the pair known, over the size of the reference's step; `gain_error`: how
        far the gain that the estimate implies is off then, of the true one.
    """
    ends = [*(time for time, _ in chosen.gains[1:]), len(run.data) / run.rate]
    found = []
    for (time, gain), end in zip(chosen.gains, ends, strict=True):
        begin, until = (round(each * run.rate) for each in (time + chosen.period, end))
        if begin >= min(until, len(run.data)):
            break
        known = simulate(InternalModel([known_pair(config, gain)]), _from_the_start(chosen, gain, config), config)
        apart = np.abs(channel(run, "position") - channel(known, "position"))[begin:until]
        size = np.abs(np.diff(chosen.reference)).max()
        believed = believed_gain(run, config)[begin - 1]
        found.append({"time": time, "gain": gain, "deviation": float(apart.max() / size),
                      "gain_error": float(abs(believed / gain - 1.0))})  # fmt: skip
    return found


def model_columns(run: Recording, loop: str) -> list[int]:
    """Return in which columns the parameters in use of the "fast" or the "slow" loop's model are."""
    return [n for n, name in enumerate(run.names) if name.startswith(f"{loop}_model")]


def believed_gain(run: Recording, config: MidrangeConfig) -> np.ndarray:
    """Return the gain of the inner process that the estimates imply, over that of the first model, shape (samples,), 1.

    The process integrates, so its gain is that of the open loop B / (A - B) to a ramp.
    """
    columns = model_columns(run, "fast")
    first = fast_loop(config)
    gain: np.ndarray = _ramp_gain(run.data[:, columns]) / _ramp_gain(first.parameters[np.newaxis, :])
    return gain


def _ramp_gain(parameters: np.ndarray) -> np.ndarray:
    """Return the open loop's gain to a ramp from parameters of shape (models, 2 order), 1 a sample: shape (models,)."""
    outputs, inputs = np.split(parameters, 2, axis=1)
    gain: np.ndarray = inputs.sum(axis=1) / ((outputs + inputs) @ np.arange(1.0, outputs.shape[1] + 1))
    return gain


def _from_the_start(chosen: Scenario, gain: float, config: MidrangeConfig) -> Scenario:
    """Return a scenario in which the process gain is that one from the first sample of the lead."""
    options = {**chosen.options, "gains": ((-config.session.lead, gain),)}
    return Scenario(chosen.name, chosen.reference, options, chosen.period)
