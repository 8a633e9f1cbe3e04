"""One row of the comparison with other packages, as text, and what rows of ours were to reach."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.measured_process import Outcome

CLOSE = 0.1
"""Points that a fit may be short of the truth's."""
DAMPING = 3.0
"""%, of every mode, from 10 000 samples."""


@dataclass(frozen=True)
class Row:
    """What one method did in one case.

    Parameters
    ----------
    order, samples, horizon : int
    method : str
    outcome : Outcome
    short : array, shape (records, 2), points of NRMSE
        By which the truth's free run and one step fit a fresh record better; NaN where there is none.
    damping : array, shape (records, modes), %
    """

    order: int
    samples: int
    horizon: int
    method: str
    outcome: Outcome
    short: np.ndarray
    damping: np.ndarray

    @property
    def worst_damping(self) -> np.ndarray:
        """Largest error of each mode over the records, shape (modes,), %."""
        largest: np.ndarray = np.abs(self.damping).max(axis=0)
        return largest

    def line(self) -> str:
        """Return it as a row of a Markdown table."""
        done = self.outcome
        if done.failure:
            said = "skipped" if done.failure.startswith("ModuleNotFoundError") else "fails"
            return f"| {self.method} | {said}: {done.failure.replace('|', '/')} | | | | | | |"
        grown = f"{done.peak:.0f} ({done.peak - done.before:.0f})"
        fits = " | ".join(_points(column) for column in self.short.T)
        errors = " ".join(f"{error:.1f}" for error in self.worst_damping)
        times = f"{1e3 * done.wall:.1f} | {1e3 * done.cpu:.1f}"
        return f"| {self.method} | {times} | {grown} | {len(self.short)} | {fits} | {errors} |"


def targets(rows: Sequence[Row], proposed: dict[tuple[int, int], list[int]]) -> None:
    """Print what was to be reached and what was."""
    print("\n### What ours were to reach\n")
    print("| | measured, worst of the records | |\n|---|---|---|")
    for row in rows:
        if row.method.startswith("ours") and row.method != "ours, n4sid":
            for name, value, limit in _wanted(row):
                name = f"{row.method}: order {row.order}, {row.samples} samples, s = {row.horizon}: {name}"
                print(f"| {name} <= {limit:g} | {value:.3g} | {_verdict(value, limit)} |")
    for (order, horizon), orders in proposed.items():
        right = sum(each == order for each in orders)
        verdict = "reached" if orders and right == len(orders) else "SHORT"
        print(f"| proposed order {order}, s = {horizon} | right in {right} of {len(orders)} | {verdict} |")


def _wanted(row: Row) -> Iterator[tuple[str, float, float]]:
    short = row.short if len(row.short) else np.full((1, 2), np.nan)
    yield "free run short, points", float(short[:, 0].max()), CLOSE
    yield "one step short, points", float(short[:, 1].max()), CLOSE
    if row.samples == 10_000:
        yield "damping of every mode, %", float(row.worst_damping.max()), DAMPING
    if row.samples == 1_000_000 and row.method == "ours":
        yield "clock, s", row.outcome.wall, 1.5
        yield "peak memory, MB", row.outcome.peak, 500.0
    if row.samples == 100_000 and row.method == "ours" and row.horizon == 20:
        limit = 0.1 if row.order == 7 else 0.25
        yield "processor time, s", row.outcome.cpu, limit
        yield "clock, s", row.outcome.wall, limit
        if row.order == 18:
            yield "peak memory, MB", row.outcome.peak, 300.0


def _verdict(value: float, limit: float) -> str:
    return "reached" if value <= limit else f"SHORT by {value - limit:.2g}"


def _points(values: np.ndarray) -> str:
    """Return mean and worst, and how many had none."""
    known = values[np.isfinite(values)]
    if not len(known):
        return "none"
    missing = f", none in {len(values) - len(known)}" if len(known) < len(values) else ""
    return f"{known.mean():.2f} ({known.max():.2f}{missing})"
