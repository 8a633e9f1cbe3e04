"""
The order in which a pocket is milled
=====================================

The feed rate of a strip depends on its direction re the grain, on its side of the tool, and on its width.  The optimal
order turns, steps and lifts where that saves time.
"""

import matplotlib.pyplot as plt

from vibrostage import planning

rate = {"E3": 0.075, "E2u": 0.048, "E1u": 0.044, "E2d": 0.054, "E1d": 0.036,
        "W3": 0.085, "W2u": 0.065, "W1u": 0.037, "W2d": 0.059, "W1d": 0.037}  # fmt: skip
pocket = planning.Pocket(14, 20, 3, "EW", rate, v_lift=50.0)
figure, both = plt.subplots(1, 2, layout="constrained", figsize=(9, 4), sharey=True)
for axes, name in zip(both, ("sequential", "exact"), strict=True):
    path = planning.plan(pocket, name)
    for number, (_, row, col, feed) in enumerate(path):
        end = pocket.cols - 3 if feed == "E" else 0
        colour = plt.cm.viridis(number / len(path))
        axes.annotate(
            "", (end + 1.5, row + 1.5), (col + 1.5, row + 1.5), arrowprops={"arrowstyle": "->", "color": colour}
        )
    total = planning.check(pocket, path).total
    axes.set(xlim=(0, pocket.cols), ylim=(pocket.rows, 0), title=f"{name}: {len(path)} segments, {total:.2f} s")
print(f"no path is shorter than {planning.least_time(pocket):.2f} s")
plt.show()
