"""Torque-position maps as they grow: a PNG a joint, and a page that shows all and looks again every two seconds."""

import io
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from calibration.joint_clamping.torque_map import MOST_SAMPLES
from rigkit import atomic
from rigkit.figure_style import COLOURS, styled

PAGE = "maps.html"
_RELOAD = 2
"""s between two looks of the browser."""


def draw_map(folder: Path, joint: int, angle: np.ndarray, torque: np.ndarray, cycles: float) -> None:
    """Draw one joint's map anew, and the page with the maps of all joints that have one.

    Parameters
    ----------
    folder : Path
    joint : int
        From 0.
    angle, torque : arrays, shape (samples,), rad and N m
        As far as they have come.
    cycles : float
        To and fro as far as they are done.
    """
    step = max(1, len(angle) // MOST_SAMPLES)
    with styled():
        figure = Figure(figsize=(8.0, 5.0))
        axes = figure.subplots()
        shown = angle[::step].astype(float)
        axes.plot(1e3 * (shown - shown.mean()), torque[::step], color=COLOURS[0], linewidth=0.8)
        axes.set(xlabel="motor's angle from its mean (mrad)", ylabel="torque (N m)")
        axes.set_title(f"joint {joint + 1}: {cycles:g} cycles")
        drawn = io.BytesIO()
        figure.savefig(drawn, format="png")
    atomic.write(folder / f"map-{joint + 1}.png", drawn.getvalue())
    images = sorted(path.name for path in folder.glob("map-*.png"))
    body = "\n".join(f'<p><img src="{name}" alt="{name}"></p>' for name in images)
    atomic.write(
        folder / PAGE,
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="{_RELOAD}">'
        f"<title>Torque-position maps</title></head>\n<body>\n{body}\n</body></html>\n",
    )


def nothing() -> None:
    """Have this module imported."""
