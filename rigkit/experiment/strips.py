"""The last seconds of signals, drawn while an experiment runs."""

import numpy as np

from rigkit.service.show import Axis, Curves, Trace

PERIOD = 0.5
"""s from one drawing to the next."""
POINTS = 500
"""Drawn of a line, about."""
TIME = Axis("time", "s")


def thinned(*lines: np.ndarray) -> list[np.ndarray]:
    """Return about `POINTS` of the samples of each of some lines of one length."""
    step = max(1, len(lines[0]) // POINTS)
    return [line[::step] for line in lines]


def strip(title: str, what: Axis, time: np.ndarray, rows: np.ndarray, names: tuple[str, ...]) -> Curves:
    """Draw columns over time.

    Parameters
    ----------
    title : str
    what : Axis
    time : array, shape (looks,), s
    rows : array, shape (looks, columns), in the unit of `what`
    names : tuple of str
        Of the columns.
    """
    shown, *columns = thinned(time, *rows.T)
    traces = tuple(Trace(name, shown, column) for name, column in zip(names, columns, strict=True))
    return Curves(title, TIME, what, traces)
