"""What the piezos were asked for, against their limits."""

from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS
from rigkit.report import Plot, Table
from stagectl.experiments.piezo.result import BOUND, Result

POINTS = 2_000


def drive_plot(result: Result) -> Plot:
    """Draw voltages and extensions of every axis, with their limits."""
    figure = Figure(figsize=(8.0, 4.6))
    limits, step = result.made.config.limits, max(1, len(result.time) // POINTS)
    panels = figure.subplots(2, 1, sharex=True)
    for axes, name, scale, unit, range_ in (
        (panels[0], "voltage", 1.0, "V", limits.voltage),
        (panels[1], "extension", 1e6, "µm", limits.extension),
    ):
        signal = result.proper(name)
        for number, axis in enumerate(result.axes):
            axes.plot(
                result.time[::step], scale * signal[::step, number], color=COLOURS[number], linewidth=0.8, label=axis
            )
        for bound in range_:
            axes.axhline(scale * bound, **BOUND)
        axes.set_ylabel(f"{name}, {unit}")
    panels[0].legend(loc="best", ncols=len(result.axes))
    panels[1].set_xlabel("time, s")
    return Plot(figure, "Piezo voltages and extensions. Dashed: limits.")


def headroom_table(result: Result) -> Table:
    """Return a row for each axis: lowest and highest voltage, extension and position of the run."""
    rows = []
    for number, axis in enumerate(result.axes):
        row = [axis]
        for name, scale in (("voltage", 1.0), ("extension", 1e6), ("position", 1e6)):
            signal = scale * result.proper(name)[:, number]
            row.append(f"{signal.min():.1f} to {signal.max():.1f}")
        rows.append(tuple(row))
    return Table(("axis", "voltage, V", "extension, µm", "position, µm"), tuple(rows))
