"""The report of trials: a table like 5.1, paths before and after, errors per iteration and along the path."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rigkit.figure_style import COLOURS, LIMIT, styled
from rigkit.report import Fact, Plot, Report, Section, Table
from stagectl.experiments.trials.campaign import norms
from stagectl.experiments.trials.done import DoneTrial
from stagectl.experiments.trials.lookback import size
from stagectl.experiments.trials.tool_path import RATE
from stagectl.robot.milling.trial_error import METHODS

AXES = ("x", "y", "z")
ACCURACY = 75e-6
"""m, of the tracker, at the most [Sörnmo 2015, sec. 5.3]."""
HEAD = ("trial", "x, µm", "y, µm", "z, µm", "MAE norm, µm", "slow, µm", "foreseen, µm", "true MAE norm, µm")
TABLE_HEAD = (
    "", "iteration 0", "best iteration", "ratio", "reduced by", "slow, reduced by", "noise of the slow, µm",
    "true, reduced by",
)  # fmt: skip
SLOW = "Slow is what errors have up to learning.cutoff, where learning acts: with little of the tracker's noise."
MAGNIFIED = 3.0
"""Times by which errors are drawn beside the path."""

Learned = Mapping[int, Sequence[DoneTrial]]
"""Trials of each method, iteration 0 first."""


def trial_rows(found: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return the errors of every trial, from `figures`, as text under `HEAD`."""
    shown = [(f"free space {k}", each) for k, each in enumerate(found["free"])]
    for method, done in found["methods"].items():
        shown += [(f"method {method}, iteration {k}", each) for k, each in enumerate(done)]
    return [(name, *_errors(each)) for name, each in shown]


def method_rows(found: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return a row a method, from `figures`, under `TABLE_HEAD`: Table 5.1."""
    rows: list[tuple[str, ...]] = []
    for method, done in found["methods"].items():
        slow_of = [each["slow_norm"] for each in done]
        best = found["best"][method]["iteration"]
        first, last = done[0]["norm"], done[best]["norm"]
        heard = _reduced(slow_of[0], slow_of[best]), f"{1e6 * done[best]['slow_noise']:.1f}"
        truths = [each.get("true_norm") for each in done]
        true = "-" if truths[0] is None or truths[best] is None else _reduced(truths[0], truths[best])
        sizes = f"{1e6 * first:.1f}", f"{1e6 * last:.1f} ({best})", f"{first / last:.1f}"
        rows.append((f"method {method}", *sizes, _reduced(first, last), *heard, true))
    return rows


def figures(free: Sequence[DoneTrial], learned: Learned) -> dict[str, Any]:
    """Return what was reached, other programs' keys, m: MAE along each axis, its norm, the slow and the true ones.

    The best iteration of a method is that of the least slow error, as the tracker sees it.
    """
    best = {str(method): int(np.argmin(norms(done))) for method, done in learned.items()}
    methods = {str(method): [_figures(each) for each in done] for method, done in learned.items()}
    return {
        "free": [_figures(each) for each in free],
        "methods": methods,
        "best": {method: {"iteration": at, **methods[method][at]} for method, at in best.items()},
    }


def trial_report(free: Sequence[DoneTrial], learned: Learned, source: Path) -> Report:
    """Make the report.

    Parameters
    ----------
    free : sequence of DoneTrial
    learned : mapping of int to sequence of DoneTrial
    source : Path
        The run's folder.
    """
    facts = tuple(
        Fact(f"slow MAE norm, method {method}", f"{1e6 * norms(done)[0]:.0f} to {1e6 * min(norms(done)):.0f} µm")
        for method, done in learned.items()
    )
    with styled():
        return Report("Learning to mill", str(source.resolve()), facts, tuple(_sections(free, learned)))


def _sections(free: Sequence[DoneTrial], learned: Learned) -> Iterator[Section]:
    about = ". ".join(f"Method {method}: {METHODS[method]}" for method in learned)
    found = figures(free, learned)
    tables = [Table(TABLE_HEAD, tuple(method_rows(found)))] if learned else []
    tables.append(Table(HEAD, tuple(trial_rows(found))))
    yield Section("Errors", f"{about}. {SLOW}" if learned else SLOW, tables=tuple(tables))
    if learned:
        yield Section("Iterations", plots=(_iterations(learned),))
    for method, done in learned.items():
        yield Section(f"Path, method {method}", plots=(_path(done),))
        yield Section(f"Error along the path, method {method}", plots=(_along(done),))
    if free:
        yield Section("Free space", plots=(_along(free),))


def _iterations(learned: Learned) -> Plot:
    figure = Figure(figsize=(8.0, 3.6))
    panels = figure.subplots(1, len(learned) + 1, sharey=True)
    for place, (method, done) in enumerate(learned.items()):
        sizes = 1e6 * np.array([each.mae for each in done])
        for axis, colour in zip(range(3), COLOURS, strict=False):
            panels[place].plot(sizes[:, axis], "o-", color=colour, label=AXES[axis], markersize=4)
        panels[place].set_title(f"Method {method}")
        panels[-1].plot(1e6 * np.array(norms(done)), "o-", color=COLOURS[2 + method], label=f"method {method}")
    panels[0].set_ylabel("MAE, µm")
    panels[-1].set_title("Norm, slow")
    for panel in panels:
        panel.set_xlabel("iteration")
        panel.axhline(1e6 * ACCURACY, **LIMIT, label="accuracy of the tracker")
        panel.set_ylim(bottom=0)
        panel.legend(loc="best")
    return Plot(figure, "Mean absolute error of each iteration as the tracker sees it.")


def _path(done: Sequence[DoneTrial]) -> Plot:
    figure = Figure(figsize=(6.4, 6.0))
    panel = figure.subplots()
    wanted, milled = done[0].trial.path.wanted, done[0].trial.path.milled
    panel.plot(*(1e3 * wanted[milled, :2].T), color="#000000", linewidth=0.8, label="desired")
    for each, colour, name in zip((done[0], done[-1]), COLOURS, (0, len(done) - 1), strict=False):
        error = each.error if each.true_error is None else each.true_error
        shown = (wanted - MAGNIFIED * error)[milled]
        panel.plot(*(1e3 * shown[:, :2].T), color=colour, linewidth=0.9, label=f"iteration {name}")
    panel.set_aspect("equal")
    panel.set_xlabel("x, mm")
    panel.set_ylabel("y, mm")
    panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), title=f"errors x {MAGNIFIED:g}")
    return Plot(figure, f"The path, errors magnified {MAGNIFIED:g} times.")


def _along(done: Sequence[DoneTrial]) -> Plot:
    figure = Figure(figsize=(8.0, 5.2))
    for axis, panel in enumerate(figure.subplots(3, 1, sharex=True)):
        for each, colour, number in zip((done[0], done[-1]), COLOURS, (0, len(done) - 1), strict=False):
            error = each.error if each.true_error is None else each.true_error
            time = np.arange(len(error)) / RATE
            panel.plot(time[::4], 1e6 * error[::4, axis], color=colour, linewidth=0.9, label=f"{number}")
        panel.set_ylabel(f"{AXES[axis]}, µm")
        if axis == 0:
            panel.legend(loc="best", ncols=2, title="trial")
        if axis == 2:
            panel.set_xlabel("time, s")
    return Plot(figure, "Reference minus position of the tool, in the first and the last trial.")


def _errors(found: Mapping[str, Any]) -> tuple[str, ...]:
    keys = "slow_norm", "foreseen", "true_norm"
    further = (f"{1e6 * found[key]:.1f}" if key in found else "-" for key in keys)
    return (*(f"{1e6 * each:.1f}" for each in found["mae"]), f"{1e6 * found['norm']:.1f}", *further)


def _figures(done: DoneTrial) -> dict[str, Any]:
    found: dict[str, Any] = {"mae": done.mae.tolist(), "norm": float(np.linalg.norm(done.mae))}
    found |= {"slow_norm": size(done), "slow_noise": float(np.linalg.norm(done.slow_noise))}
    if done.trial.foreseen:
        found["foreseen"] = done.trial.foreseen
    if done.true_mae is not None:
        found |= {"true_mae": done.true_mae.tolist(), "true_norm": float(np.linalg.norm(done.true_mae))}
    return found


def _reduced(first: float, last: float) -> str:
    return f"{100 * (1 - last / first):.0f} %"
