"""What milling oak costs, by feed and strip: the force for a feed, and the force across over that along."""

import numpy as np

PUBLISHED = ((6.25, 6.05, 11.05, 6.75, 8.95), (7.05, 8.15, 9.25, 7.40, 9.20))
"""ms/mm^2, means of both training passes of Experiment 1 [Sörnmo 2015, sec. 7.3]: along +x, then -x; slot, 2/3 up,
1/3 up, 2/3 down, 1/3 down; 10 N, a tool of 6 mm, 3 mm deep."""
WIDTHS = (6.0, 4.0, 2.0, 4.0, 2.0)
"""mm, of each of them."""
FORCE = 10.0
"""N, at which they were milled."""
BETAS = ((0.50, 0.35, 0.20, 0.65, 0.80), (0.60, 0.45, 0.30, 0.75, 0.90))
"""The force across the feed, to the left, over that against it: of the slot as the thesis begins with; the others are
assumed."""


def drags() -> np.ndarray:
    """Return the force along for a feed, 1 / kappa, and beta: shape (2, 2, 2, 4), N s/m and 1.

    By +x and -x; up and down; thirds of the tool's width from 0.  A tool that touches nothing feels nothing.
    """
    found = np.zeros((2, 2, 2, 4))
    for way in range(2):
        for hand in range(2):
            for third, column in ((3, 0), (2, 1 + 2 * hand), (1, 2 + 2 * hand)):
                feed = 1.0 / (PUBLISHED[way][column] * WIDTHS[column])
                beta = BETAS[way][column]
                found[0, way, hand, third] = FORCE / (feed * np.hypot(1.0, beta))
                found[1, way, hand, third] = beta
            found[1, way, hand, 0] = found[1, way, hand, 1]
    return found
