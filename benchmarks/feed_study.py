"""The table of `studies/feed-force.toml` in docs/validation/force.md."""

import numpy as np

from rigkit.report import Table
from rigkit.study.report import StudyReport
from rigkit.study.summary import share_of
from rigkit.study.tables import markdown

FIGURES = {
    "error": ("mean error of the force, %", 100.0, 0.01),
    "settled": ("settled to 10 %, s", 1.0, 0.4),
    "overshoot": ("largest force over that wanted", 1.0, 2.0),
}
"""Title, by what it is multiplied, and what it is to be at most."""
HEAD = ("", "far half", "N", "told", "median", "its 95 % interval", "95th percentile", "worst", "passes", "share")
DRAWS = 10_000


def feed_force_table(found: StudyReport) -> str:
    """Return a row a figure and hardness; what was held counts in N, and its figures up to then as they are."""
    rows = []
    for name, (title, scale, most) in FIGURES.items():
        for step, words in ((1.0, "as it is drawn"), (3.0, "three times as hard")):
            here = [row for row in found.rows if next(iter(row.case.values())) == step]
            told = np.array([float(row.figures[name]) for row in here if row.figures.get(name) is not None])
            passed = sum(
                not row.status and row.figures.get(name) is not None and float(row.figures[name]) <= most
                for row in here
            )
            again = np.median(np.random.default_rng(1).choice(told, (DRAWS, len(told))), axis=1)
            low, high = (scale * each for each in np.quantile(again, [0.025, 0.975]))
            median, late, worst = (scale * float(each) for each in np.quantile(told, [0.5, 0.95, 1.0]))
            share = share_of(passed, len(here))
            cells = f"{median:.3g}", f"{low:.3g} to {high:.3g}", f"{late:.3g}", f"{worst:.3g}"
            at_most = f"<= {scale * most:g}: {share.text}"
            rows.append((title, words, f"{len(here)}", f"{len(told)}", *cells, at_most, share.interval))
    return markdown(Table(HEAD, tuple(rows)))
