"""How far back and ahead windows reach: as told, or as records, order and the slowest oscillation want it."""

import numpy as np

from calibration.state_space.modes import modes
from calibration.subspace.signals import Signals
from calibration.subspace.windows import Layout

_HORIZON = 40
"""Samples, past and future, where records are long enough."""
_SHORTEST = 5
_WINDOWS = 3
"""So many windows a row of the triangle are wanted of default horizons."""
_PERIODS = 2.0
"""Of the slowest oscillation that are reached over: then dampings are within a tenth of the least error."""
_ENOUGH = 1.25
"""Horizons that are too short by less than this factor are left as they are."""
_OSCILLATES = 0.3
"""Damping ratio, below."""
_ROWS = 640
"""Of the triangle, at most, where horizons are made longer: beyond, work and memory grow faster than what is gained."""


def given(data: Signals, horizon: int | tuple[int, int], order: int | None) -> Layout:
    """Return horizons that were asked for, checked against the records and the order.

    Parameters
    ----------
    data : Signals
    horizon : int or (past, future), samples
    order : int, optional

    Raises
    ------
    ValueError : horizons that the records are too short for, or an order that the horizons cannot tell.
    """
    past, future = (horizon, horizon) if isinstance(horizon, int) else horizon
    layout = Layout(past, future, len(data.input_scale), len(data.output_scale))
    windows = sum(len(drive) - layout.length + 1 for drive in data.drives)
    if _shortest(data) < layout.length or windows < len(layout.order):
        raise ValueError(
            f"records have {[len(drive) for drive in data.drives]} samples, too few for horizons of {past} and "
            f"{future}: each must have {layout.length}, all together "
            f"{len(layout.order) + len(data.drives) * (layout.length - 1)}"
        )
    if order is not None and not 1 <= order <= layout.largest_order:
        raise ValueError(f"order is {order}, must be 1 to {layout.largest_order} with horizons of {past} and {future}")
    return layout


def usual(data: Signals, order: int | None) -> Layout:
    """Return the horizons to begin with: 40 and 40, less if records are short, more if the order wants it.

    Parameters
    ----------
    data : Signals
    order : int, optional
    """
    wanted = _HORIZON if order is None else max(_HORIZON, 2 * -(-order // len(data.output_scale)))
    return given(data, max(_SHORTEST, min(wanted, affordable(data), _shortest(data) // 4)), order)


def longer(layout: Layout, data: Signals, transition: np.ndarray) -> Layout | None:
    """Return horizons that reach over the slowest oscillation of a model, or none where these (nearly) do.

    Both grow: with a short past the order is taken too small, with a short future dampings are uncertain.

    Parameters
    ----------
    layout : Layout
        That the model was found with.
    data : Signals
    transition : array, shape (n, n), 1
        The model's A.
    """
    found = modes(np.linalg.eigvals(transition), 1.0)
    oscillating = found.frequency[(found.damping < _OSCILLATES) & (found.frequency > 0)]
    if not len(oscillating):
        return None
    room = min(affordable(data), _ROWS // (2 * _width(data)), _shortest(data) // 4)
    horizon = min(int(np.ceil(_PERIODS / oscillating.min())), room)
    if not horizon > _ENOUGH * layout.future:
        return None
    return Layout(horizon, horizon, layout.inputs, layout.outputs)


def affordable(data: Signals) -> int:
    """Return the longest horizon that leaves so many windows for each row of the triangle."""
    return (data.samples + 2) // (2 * _WINDOWS * _width(data) + 2 * len(data.drives))


def _width(data: Signals) -> int:
    return len(data.input_scale) + len(data.output_scale)


def _shortest(data: Signals) -> int:
    return min(len(drive) for drive in data.drives)
