"""The tables of `studies/milling.toml`, `milling-deep.toml` and `milling-soft.toml` in docs/validation/milling.md."""

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from rigkit.report import Table
from rigkit.study.report import StudyReport
from rigkit.study.results import Row
from rigkit.study.summary import share_of
from rigkit.study.tables import markdown

METHODS = {"tracker": (1, 0.8), "sensor": (2, 0.7), "torques": (3, 0.6)}
"""By the figure of its best trial: a method, and the reduction that is asked for in the median."""
ARMS = "irb140", "kuka"
"""Machines of a study that are arms as cells are drawn."""
BLOCKS = 0.05
"""Of an error, by which trials of one path differ from block to block."""
DRAWS = 10_000
REFUSED = 2
"""Exit status of what is refused."""
HEAD = (
    "arm", "method", "N", "refused", "not compensated, µm", "best trial, µm", "reduced by, median", "95 % interval",
    "asked", "that or more",
)  # fmt: skip
WORSE_HEAD = ("arm", "method", "N", "no trial worse", "none by more than noise", "95 % interval", "worst over first")
SOFT_HEAD = ("joints", "method", "N", "refused", "reduced by, median", "none worse beyond noise", "worst over first")
WHY = {
    "bent by .* times what G_K": "the slope of what the tracker saw on G_K f",
    "went .* times as far as G_R": "the slope of the motors' path on G_R's",
    "s later than the tracker": "the lateness of the force",
    "in air cuts the tool is": "trials in the air that get worse",
    "is predicted .* from where it is wanted": "a path that would stray",
    "is not determined": "torques that do not determine the force",
}
"""What is said where a method is refused, and what was noticed by it."""


def milling_table(found: StudyReport) -> str:
    """Return a row an arm and method: what is won, and whether a trial made it worse."""
    ended = _ended(found)
    arms = [(arm, [row for row in ended if row.machine == arm]) for arm in dict.fromkeys(row.machine for row in ended)]
    arms.append(("both arms, as drawn", [row for row in ended if row.machine in ARMS]))
    won = [_won(arm, rows, name) for arm, rows in arms for name in METHODS]
    worse = [_worse(arm, rows, name) for arm, rows in arms for name in METHODS]
    air = [1e6 * np.array(_told(ended, name)) for name in ("first", "air")]
    middle = [f"{np.median(each):.0f} ({each.min():.0f} to {each.max():.0f})" for each in air]
    said = (
        f"In the air the tool was {middle[0]} µm off its path in the median (least to most), and {middle[1]} µm after "
        "learning there; what is not compensated, below, is milled by that path. Medians are of the cells that were "
        "learned, at the iteration that the tracker's slow errors name best; errors are the tool's true ones. "
        "Intervals of medians: bootstrap, 95 %."
    )
    noise = (
        f"A trial is worse by more than noise where it exceeds the first one by more than {100 * BLOCKS:.0f} % of it "
        "(two blocks) and the tracker's noise up to `learning.cutoff`, added as squares."
    )
    tables = markdown(Table(HEAD, tuple(won))), noise, markdown(Table(WORSE_HEAD, tuple(worse)))
    return "\n\n".join([said, *tables]) + "\n"


def soft_table(found: StudyReport) -> str:
    """Return a row for how many times as soft as its model the robot is, and method; and what it was noticed by."""
    rows = []
    ended = _ended(found)
    for times in sorted({next(iter(row.case.values())) for row in ended}):
        here = [row for row in ended if next(iter(row.case.values())) == times]
        for name, (method, _) in METHODS.items():
            cut = _reductions(here, name)
            *_, within, _, ratio = _worse("", here, name)
            counts = f"{method}", f"{len(here)}", f"{len(here) - len(cut)}"
            median = f"{100 * np.median(cut):.0f} %" if cut else "-"
            rows.append((f"x {times:g}", *counts, median, within, ratio))
    noticed = Counter(why for row in ended for why in _reasons(row.message))
    said = "; ".join(f"{why} ({count})" for why, count in noticed.most_common()) or "nothing"
    return f"{markdown(Table(SOFT_HEAD, tuple(rows)))}\n\nNoticed by: {said}.\n"


def _ended(found: StudyReport) -> list[Row]:
    """Return the tasks that came to their end, or to a refusal; those that were killed tell nothing of learning."""
    return [row for row in found.rows if row.status in (0, REFUSED)]


def _won(arm: str, rows: Sequence[Row], name: str) -> tuple[str, ...]:
    method, asked = METHODS[name]
    cut = _reductions(rows, name)
    refused = len(rows) - len(cut)
    if not cut:
        return (arm, f"{method}", f"{len(rows)}", f"{refused}", *("-" for _ in HEAD[4:]))
    there = _learned(rows, name)
    sizes = (f"{1e6 * np.median([row.figures[key] for row in there]):.0f}" for key in ("before", name))
    again = np.median(np.random.default_rng(1).choice(cut, (DRAWS, len(cut))), axis=1)
    low, high = np.quantile(again, [0.025, 0.975])
    share = share_of(sum(each >= asked for each in cut), len(rows))
    won = f"{100 * np.median(cut):.0f} %", f"{100 * low:.0f} to {100 * high:.0f} %"
    return (arm, f"{method}", f"{len(rows)}", f"{refused}", *sizes, *won, f"{100 * asked:.0f} %", share.text)


def _worse(arm: str, rows: Sequence[Row], name: str) -> tuple[str, ...]:
    there = _learned(rows, name)
    first, worst, noise = (np.array(_told(there, key)) for key in ("before", f"worst_{name}", "noise"))
    none = int(np.sum(worst <= first))
    within = share_of(int(np.sum(worst <= first + np.hypot(BLOCKS * first, noise))), len(there))
    ratio = f"{np.max(worst / first):.2f}" if len(there) else "-"
    return (arm, f"{METHODS[name][0]}", f"{len(there)}", f"{none}", within.text, within.interval, ratio)


def _reductions(rows: Sequence[Row], name: str) -> list[float]:
    there = _learned(rows, name)
    return [1.0 - after / before for before, after in zip(_told(there, "before"), _told(there, name), strict=True)]


def _learned(rows: Sequence[Row], name: str) -> list[Row]:
    """Return the tasks in which a method was learned by."""
    return [row for row in rows if row.figures[name] is not None]


def _told(rows: Sequence[Row], name: str) -> list[float]:
    return [float(value) for row in rows if (value := row.figures[name]) is not None]


def _reasons(message: str) -> list[str]:
    return [why for pattern, why in WHY.items() for _ in re.findall(pattern, message)]
