"""How well the force was held: its mean error, how soon it settled, and how far it went beyond what was wanted."""

from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from stagectl.experiments.feed.process_run import channel
from stagectl.robot.config import CellConfig
from stagectl.robot.milling.feed_record import CONTROLLING

BRAKING = 0.1
"""s before the end of a segment that are not looked at: it is braked for."""
MEAN, WITHIN, FIRST = 0.1, 0.1, 1.0
"""s over which the mean is to be within a part of the force wanted, and s that are looked at."""
LEAST = 0.2
"""s of stationary control, without which there is no mean error."""


def held(record: Recording, cell: CellConfig) -> dict[str, float | None]:
    """Return `force_error`, `force_settled` and `force_overshoot`, as `measures.figures` has them.

    Parameters
    ----------
    record : Recording
    cell : CellConfig
    """
    force, wanted, rate = channel(record, "resultant"), cell.force.force, record.rate
    on = channel(record, "phase") == CONTROLLING
    braked, early = round(BRAKING * rate), round(cell.segments.stationary * rate)
    late, settled, largest = [np.zeros(0)], list[float](), list[float]()
    for begin, end in _stretches(channel(record, "is_running") > 0.5):
        controlled = begin + np.flatnonzero(on[begin:end])
        if len(controlled) <= braked:
            continue
        controlled = controlled[: len(controlled) - braked]
        late.append(force[controlled[early:]])
        settled.append(_settled(force[controlled], wanted, rate))
        largest.append(float(force[begin : controlled[-1]].max(initial=0.0) / wanted))
    found: dict[str, Any] = dict.fromkeys(("force_error", "force_settled", "force_overshoot"))
    if settled:
        found |= {"force_settled": max(settled), "force_overshoot": max(largest)}
    if len(whole := np.concatenate(late)) >= LEAST * rate:
        found["force_error"] = float(abs(whole.mean() / wanted - 1.0))
    return found


def _stretches(is_on: np.ndarray) -> list[tuple[int, int]]:
    """Return where each stretch of true samples begins, and where it has ended."""
    edges = np.diff(np.concatenate([[0], is_on.astype(int), [0]]))
    return list(zip(np.flatnonzero(edges > 0).tolist(), np.flatnonzero(edges < 0).tolist(), strict=True))


def _settled(force: np.ndarray, wanted: float, rate: float) -> float:
    """Return from when on the mean stays near what is wanted, s from the first sample."""
    width = round(MEAN * rate)
    if len(force) < width:
        return len(force) / rate
    mean = np.convolve(force, np.full(width, 1.0 / width), "valid")[: round(FIRST * rate)]
    outside = np.flatnonzero(np.abs(mean / wanted - 1.0) > WITHIN)
    return float((outside[-1] + 1) / rate) if len(outside) else 0.0
