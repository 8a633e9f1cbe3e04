"""How hard a block is from place to place: grain, knots, and boards glued side by side; maps of 1 mm."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from scipy.ndimage import gaussian_filter

from firmware_sim.plants.tooth_cut_kernel import SPOT


@dataclass(frozen=True)
class Hardness:
    """What makes a block harder here than there.

    Parameters
    ----------
    grain : float, 1
        Standard deviation of the logarithm from place to place.
    fibre : (float, float), m
        Over which that changes along x, the fibres, and across them.
    knots : int
    knot, knot_size : float, 1 and m
        By what each is harder, and its radius.
    boards : sequence of float, 1
        By what each of some boards side by side is harder; one of 1 for a whole block.
    heading : float, rad
        In which direction board follows on board.
    scatter : float, 1
        Relative standard deviation from block to block, cut off at two of it.
    """

    grain: float = 0.0
    fibre: tuple[float, float] = (12e-3, 1.5e-3)
    knots: int = 0
    knot: float = 1.0
    knot_size: float = 3e-3
    boards: Sequence[float] = (1.0,)
    heading: float = 0.0
    scatter: float = 0.0

    def grown(self, seed: int, length: float, width: float) -> np.ndarray:
        """Return the map of a block, shape (y, x), 1, its middle in the middle.

        Parameters
        ----------
        seed : int
            Of the block: its grain, where its knots are, how hard it is beside others.
        length, width : float, m, along x and y
        """
        rng = np.random.default_rng([seed, 8])
        columns, rows = (2 * ceil(0.5 * side / SPOT) + 3 for side in (length, width))
        x, y = ((np.arange(count) - 0.5 * (count - 1)) * SPOT for count in (columns, rows))
        rough = gaussian_filter(rng.standard_normal((rows, columns)), [each / SPOT for each in self.fibre[::-1]])
        found = np.exp(self.grain * rough / max(float(rough.std()), 1e-12))
        for middle_x, middle_y in rng.uniform(-0.5, 0.5, (self.knots, 2)) * (length, width):
            away = ((x - middle_x)[None] ** 2 + (y - middle_y)[:, None] ** 2) / self.knot_size**2
            found *= 1.0 + (self.knot - 1.0) * np.exp(-(away**2))
        across = np.cos(self.heading) * x[None] + np.sin(self.heading) * y[:, None]
        span = abs(np.cos(self.heading)) * length + abs(np.sin(self.heading)) * width
        board = np.floor((across / span + 0.5) * len(self.boards)).astype(int)
        found *= np.array(self.boards, float)[np.clip(board, 0, len(self.boards) - 1)]
        return np.asarray(found * (1.0 + self.scatter * np.clip(rng.standard_normal(), -2, 2)))
