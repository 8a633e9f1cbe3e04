"""How the figures of a run draw a shot, many samples in little room, and levels in dB."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from rigkit.figure_style import COLOURS, LIMIT
from vibractl.figures.result import Result, Shot

DRAWN = 1200
"""Points across a figure: two a millimetre in print."""
SPANS = 100
"""Of an envelope: each longer than a period from 20 Hz on when the shot is 5 s."""
BOUND: dict[str, Any] = {**LIMIT}
REFERENCE: dict[str, Any] = {"color": "#000000", "linewidth": 0.9, "label": "reference"}


def look(result: Result, shot: Shot) -> dict[str, Any]:
    """Return colour and label of a shot: the last in blue in front, the first in vermilion behind."""
    last = shot is result.last
    return {"color": COLOURS[0] if last else COLOURS[1], "label": f"shot {shot.number}", "zorder": 3 if last else 2}


def legend_above(axes: Axes) -> None:
    """Put the legend over the axes, right of their title, where it hides nothing."""
    entries = len(axes.get_legend_handles_labels()[1])
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, frameon=False, ncols=entries)


def draw_envelope(axes: Axes, time: np.ndarray, signal: np.ndarray, style: dict[str, Any]) -> None:
    """Fill between the smallest and the largest sample of each of `SPANS` spans, so that no peak is lost.

    Parameters
    ----------
    axes : Axes
    time : array, shape (samples,), s
    signal : array, shape (samples,), any unit
    style : dict, as `look` gives it
    """
    step = -(-len(signal) // SPANS)
    starts = np.arange(0, len(signal), step)
    low, high = np.minimum.reduceat(signal, starts), np.maximum.reduceat(signal, starts)
    middle = time[np.minimum(starts + step // 2, len(time) - 1)]
    axes.fill_between(middle, low, high, linewidth=0.6, **style)


def largest_by_span(frequency: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest line of each of at most `DRAWN` spans, and where it lies: no line that stands out is lost.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz
    size : array, shape (lines,), any unit

    Returns
    -------
    two arrays, shape (spans,)
    """
    step = -(-len(size) // DRAWN)
    place = [start + int(np.argmax(size[start : start + step])) for start in range(0, len(size), step)]
    return frequency[place], size[place]
