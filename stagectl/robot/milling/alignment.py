"""Signals of different clocks and rates, brought to one time: shifts found, gaps refused, samples on one grid."""

import numpy as np
from scipy.optimize import minimize_scalar

from stagectl.robot.milling.zero_phase import low_passed

CUTOFF = 10.0
"""Hz, below which shapes are compared: noise is smaller between two samples than on one, and would draw a shift there.
"""


def on_grid(time: np.ndarray, values: np.ndarray, grid: np.ndarray, longest_gap: float, name: str) -> np.ndarray:
    """Interpolate samples linearly at other times.

    Parameters
    ----------
    time : array, shape (N,), s, rising
    values : array, shape (N, width), any unit
    grid : array, shape (M,), s, rising
    longest_gap : float, s
        Without a sample within the grid's span.
    name : str
        Of the signal, for what is refused.

    Returns
    -------
    array, shape (M, width), the values' unit

    Raises
    ------
    ValueError : time that does not rise, a value that is not finite, a gap, or ends that do not reach.
    """
    time, values = np.asarray(time, float), np.asarray(values, float)
    if len(time) < 2 or not np.isfinite(time).all() or not (np.diff(time) > 0).all():
        at = int(np.argmin(np.diff(time) > 0)) + 1 if len(time) > 1 else 0
        raise ValueError(f"{name}: its time does not rise at sample {at}")
    if not np.isfinite(values).all():
        raise ValueError(f"{name}: it is not finite at {time[int(np.argwhere(~np.isfinite(values))[0][0])]:.6g} s")
    if time[0] > grid[0] + longest_gap or time[-1] < grid[-1] - longest_gap:
        raise ValueError(
            f"{name}: it lasts from {time[0]:.6g} to {time[-1]:.6g} s, must last from {grid[0]:.6g} to {grid[-1]:.6g} s"
        )
    inside = time[(time >= grid[0] - longest_gap) & (time <= grid[-1] + longest_gap)]
    gap = np.diff(inside)
    if len(gap) and not gap.max() <= longest_gap:
        at = int(np.argmax(gap))
        raise ValueError(
            f"{name}: there is no sample for {gap[at]:.3g} s from {inside[at]:.6g} s on, must be <= {longest_gap:g} s"
        )
    return np.stack([np.interp(grid, time, each) for each in values.T], axis=-1)


def shift(reference: np.ndarray, late: np.ndarray, rate: float, most: float) -> float:
    """Return by how much a signal is late beside another that has the same shape, s; less than 0 where it is early.

    Parameters
    ----------
    reference, late : arrays, shapes (N, width) and (M, width), any unit
        Samples at one rate, each from its own start; offsets do not count.
    rate : float, samples/s
    most : float, s
        Largest shift that is looked for.

    Raises
    ------
    ValueError : a reference that does not move, or records that do not overlap by half of the shorter.
    """
    reference, late = (low_passed(each, rate, CUTOFF) for each in (reference, late))
    if not np.ptp(reference, axis=0).max() > 0:
        raise ValueError("the signal to align with does not move")
    reach, shortest = round(most * rate), min(len(reference), len(late)) // 2
    steps = np.arange(-reach, reach + 1)
    cost = np.array([_mismatch(reference, late, float(step), shortest) for step in steps])
    if not np.isfinite(cost).any():
        raise ValueError(f"the signals do not overlap within {most:g} s by half of the shorter")
    best = int(np.argmin(cost))
    near = (float(steps[best]) - 1.0, float(steps[best]) + 1.0)
    found = minimize_scalar(
        lambda step: _mismatch(reference, late, step, shortest), bounds=near, method="bounded", options={"xatol": 1e-4}
    )
    return float(found.x) / rate


def _mismatch(reference: np.ndarray, late: np.ndarray, step: float, shortest: int) -> float:
    """Return the mean square of what is left between them, shifted by `step` samples; infinite with little overlap."""
    first, last = max(0, int(np.ceil(-step))), min(len(reference), int(np.floor(len(late) - 1 - step)) + 1)
    if last - first < shortest:
        return float(np.inf)
    here = reference[first:last]
    place = np.arange(first, last) + step
    at = np.clip(np.floor(place).astype(int), 0, len(late) - 2)
    part = (place - at)[:, None]
    left = (1.0 - part) * late[at] + part * late[at + 1] - here
    return float(np.mean((left - left.mean(axis=0)) ** 2))
