"""The figures of a mid-ranging run."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ctlblocks.recording import Recording
from rigkit.figure_style import COLOURS, LIMIT
from rigkit.report import Plot
from stagectl.experiments.midranging.measures import (
    believed_gain,
    channel,
    model_columns,
    taken_over_at,
    together,
)
from stagectl.experiments.midranging.scenario import RADIUS, Scenario
from stagectl.robot.midranging_config import MidrangeConfig

MILLI, MICRO = 1e3, 1e6
BOUND: dict[str, Any] = {**LIMIT}
"""Keywords of a line that shows a limit."""
_UNSEEN = 0.05
BLUE, RED, GREEN, PURPLE = COLOURS[:4]


def position_plot(run: Recording, chosen: Scenario, config: MidrangeConfig) -> Plot:
    """Draw the relative position with its reference, and below it both manipulators' positions.

    A micro manipulator that could not be seen beside the macro one has a panel of its own.
    """
    apart = np.abs(channel(run, "fast")).max() < _UNSEEN * np.abs(channel(run, "slow")).max()
    figure, panels = _panels(2 + apart, 7.6 if apart else 5.6)
    time = _time(run)
    panels[0].plot(time, MILLI * channel(run, "relative"), color=BLUE, label="relative position")
    panels[0].plot(time, MILLI * channel(run, "reference"), color=RED, linewidth=0.9, label="reference")
    panels[1].plot(time, MILLI * channel(run, "slow"), color=GREEN, label="macro manipulator")
    panels[-1].plot(time, MILLI * channel(run, "fast"), color=PURPLE, label="micro manipulator")
    ends = config.pair.middle - config.pair.travel, config.pair.middle + config.pair.travel
    near = np.abs(channel(run, "fast") - config.pair.middle).max() > 0.5 * config.pair.travel
    for end in ends if near else ():
        panels[-1].axhline(MILLI * end, **BOUND)
    for panel in panels:
        panel.set_ylabel("position, mm")
        panel.legend(loc="upper left", ncols=2)
    caption = "Relative position and its reference; both manipulators' positions. "
    caption += "The micro manipulator returns to the middle of its travel while the macro manipulator takes over."
    if near:
        caption += " Dashed: ends of the travel."
    return Plot(figure, caption + _mark(panels, chosen, run))


def error_plot(run: Recording, chosen: Scenario) -> Plot:
    """Draw the error of the relative position itself."""
    figure, panels = _panels(1, 2.6)
    error = MILLI * (channel(run, "reference") - channel(run, "position"))
    panels[0].plot(_time(run), error, color=BLUE, linewidth=0.9)
    panels[0].set_ylabel("error, mm")
    return Plot(figure, "Reference less relative position, without the sensors' noise." + _mark(panels, chosen, run))


def control_plot(run: Recording, chosen: Scenario, config: MidrangeConfig) -> Plot:
    """Draw the inner control signal against its limit, and the governor's share."""
    governed = "share" in run.names
    figure, panels = _panels(1 + governed, 4.8 if governed else 2.8)
    time = _time(run)
    panels[0].plot(time, MILLI * channel(run, "control"), color=BLUE, linewidth=0.9)
    for limit in (-config.inner.limit, config.inner.limit):
        panels[0].axhline(MILLI * limit, **BOUND)
    panels[0].set_ylabel("control signal, mm/s")
    caption = "Control signal inside the micro manipulator's loop, ahead of its saturation. Dashed: the limit."
    if governed:
        panels[1].plot(time, channel(run, "share"), color=GREEN, linewidth=0.9)
        panels[1].set_ylabel("governor's share, 1")
        caption += " Below: alpha, the share of the requested change of the reference that the governor passes."
    return Plot(figure, caption + _mark(panels, chosen, run))


def model_plot(run: Recording, chosen: Scenario, config: MidrangeConfig) -> Plot:
    """Draw how both models changed, and the process gain they imply, with the true gain where it is known."""
    figure, panels = _panels(3, 7.2)
    time = _time(run)
    for panel, loop in zip(panels, ("fast", "slow"), strict=False):
        columns = model_columns(run, loop)
        for place, column in enumerate(columns):
            half = len(columns) // 2
            label = f"{'a' if place < half else 'b'}{place % half + 1}"
            changed = run.data[:, column] - run.data[0, column]
            panel.plot(time, changed, color=COLOURS[place], linewidth=0.9, label=label)
        panel.set_ylabel(f"change, {'micro' if loop == 'fast' else 'macro'}, 1")
        panel.legend(loc="upper left", ncols=len(columns))
    panels[2].plot(time, believed_gain(run, config), color=BLUE, label="implied by the model")
    if chosen.gains:
        edges = [0.0, *(at for at, _ in chosen.gains), time[-1]]
        truth = [1.0, *(gain for _, gain in chosen.gains)]
        panels[2].stairs(truth, edges, baseline=None, color=RED, linestyle="--", label="true")
    panels[2].legend(loc="upper left", ncols=2)
    panels[2].set_ylabel("process gain, 1")
    caption = (
        "Change of the parameters in use of both models since the first sample; the inner process' gain they imply."
    )
    return Plot(figure, caption + _mark(panels, chosen, run))


def circle_plot(runs: Mapping[str, Recording]) -> Plot:
    """Draw how far the relative position is off the toroid's circle, around it, and the microns beside each other."""
    figure = Figure(figsize=(6.5, 6.0))
    axes = figure.add_subplot(projection="polar")
    x, y = together(runs, "position")
    off = MICRO * (np.hypot(x, y - RADIUS) - RADIUS)
    axes.plot(np.arctan2(y - RADIUS, x), off, color=BLUE, linewidth=0.9)
    most = max(float(np.abs(off).max()), 1.0)
    axes.set_ylim(-4.0 * most, 1.5 * most)
    axes.plot(np.linspace(0.0, 2.0 * np.pi, 361), np.zeros(361), **BOUND)
    axes.set_title("off the circle, µm")
    return Plot(figure, f"Distance from the circle of {MILLI * RADIUS:g} mm, drawn large; dashed: the circle itself.")


def _panels(count: int, height: float) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(8.0, height))
    panels = list(figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0])
    panels[-1].set_xlabel("time, s")
    return figure, panels


def _time(run: Recording) -> np.ndarray:
    """Return the time of every sample, shape (samples,), s."""
    time: np.ndarray = np.arange(len(run.data)) / run.rate
    return time


def _mark(panels: list[Axes], chosen: Scenario, run: Recording) -> str:
    """Mark what happens to the pair and who controls it, and return what is to be said of that."""
    happens = [at for at, _ in chosen.gains]
    happens += [chosen.options["disturbed_at"]] if chosen.options.get("disturbance") else []
    taken = taken_over_at(run)
    for panel in panels:
        for at in happens:
            panel.axvline(at, color="#666666", linestyle=":", linewidth=1.0)
        if taken is not None:
            panel.axvspan(taken, len(run.data) / run.rate, color=RED, alpha=0.08, linewidth=0.0)
    said = (" Dotted: the process gain changes." if chosen.gains else " Dotted: a step disturbance.") if happens else ""
    return said + (" Shaded: valve position control has taken over." if taken is not None else "")
