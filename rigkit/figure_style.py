"""How figures look: one style, colours that colour-blind readers tell apart, sizes that survive a phone."""

from contextlib import AbstractContextManager
from typing import Any

import matplotlib as mpl
from matplotlib.rcsetup import cycler

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
"""Blue, vermilion, green, purple, sky, orange, black: Okabe and Ito's set without its yellow, faint on white.

Source: M. Okabe and K. Ito, Color Universal Design, 2008, https://jfly.uni-koeln.de/color/.
"""

LIMIT = {"color": "#000000", "linestyle": "--", "linewidth": 1.0}
"""Keywords of a line that shows a limit."""

_STYLE: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": "#666666",
    "axes.grid": True,
    "axes.labelsize": 10,
    "axes.prop_cycle": cycler(color=COLOURS),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titley": 1.0,  # no search for what stands above: nothing does
    "figure.constrained_layout.h_pad": 0.08,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.w_pad": 0.08,
    "figure.figsize": (8.0, 4.0),
    "font.size": 10,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "image.cmap": "viridis",
    "legend.fontsize": 9,
    "legend.framealpha": 0.9,
    "legend.frameon": True,
    "lines.linewidth": 1.3,
    "savefig.dpi": 160,
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "vibrostage",
    "xtick.color": "#333333",
    "ytick.color": "#333333",
}


def styled() -> AbstractContextManager[None]:
    """Give figures made in the block, or in the function this decorates, the style of the reports.

    Make them with `matplotlib.figure.Figure()`, 8 by 4 inches unless said otherwise, and not through pyplot, which
    keeps every figure it ever made.
    """
    return mpl.rc_context(_STYLE)
