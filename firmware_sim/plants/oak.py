"""Milling oak: a tool that is pressed into wood which gives way more slowly here than there."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from scipy.ndimage import gaussian_filter

from firmware_sim.plants import oak_kernel as kernel
from firmware_sim.plants.oak_table import drags
from firmware_sim.plants.options import option, refuse_rate, refuse_wrong_options
from firmware_sim.plants.workpiece_kernel import GRID

FIBRE = 12e-3, 1.5e-3
"""m, over which the grain changes along x, the fibres, and across them; assumed: year rings of some mm."""


@dataclass(eq=False, kw_only=True)
class OakOptions:
    """Which piece of oak, which tool; defaults of Sörnmo 2015, sec. 7.3, where it prints them.

    Parameters
    ----------
    seed : int
        Draws grain and knots.
    tool : float, m, diameter
    depth : float, m
        Of the cut for which the published feeds stand.
    length, width : float, m, along x, the fibres, and y
    cell : float, m, of the grid on which it is remembered what is cut
    stiffness : float, N/m
        Of wood and tool.
    spread : float, 1
        Standard deviation of the logarithm of the wood's hardness from place to place.
    knots : int
    knot, knot_size : float, 1 and m
        By what they are harder, and their radius.
    across : float, 1
        By what it is harder across the fibres, in excess.
    wear : float, 1/m
        By what the tool's force grows with the way that it has milled.
    spindle : float, Hz
    tooth, runout : float, 1
        Of the mean force: amplitude at twice the spindle's frequency, two teeth, and at the spindle's own.
    origin : sequence of float, m, 3, the middle of the top in the base

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    seed: int = option(1, "", 0)
    tool: float = option(6e-3, "m", 1e-3, 0.02)
    depth: float = option(3e-3, "m", 1e-4, 0.05)
    length: float = option(90e-3, "m", 5e-3, 0.3)
    width: float = option(90e-3, "m", 5e-3, 0.3)
    cell: float = option(1e-4, "m", 2e-5, 5e-4)
    stiffness: float = option(150e3, "N/m", 1e3, 1e7)
    spread: float = option(0.12, "1", 0.0, 0.5)
    knots: int = option(2, "", 0, 100)
    knot: float = option(1.8, "1", 1.0, 10.0)
    knot_size: float = option(3e-3, "m", 1e-4, 0.05)
    across: float = option(0.2, "1", 0.0, 5.0)
    wear: float = option(0.02, "1/m", 0.0, 10.0)
    spindle: float = option(11_000 / 60, "Hz", 10.0, 1_000.0)
    tooth: float = option(0.6, "1", 0.0, 1.0)
    runout: float = option(0.15, "1", 0.0, 1.0)
    origin: Sequence[float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)
        if not (len(self.origin) == 3 and np.all(np.isfinite(self.origin))):
            raise ValueError(f"simulator.options.origin is {self.origin!r}, must be 3 numbers, m")


@dataclass(eq=False)
class OakMilling(OakOptions):
    """An end mill along -z in oak whose top is at z = 0.

    The force along the tool's way is K (p - c), where c is how far wood is removed; c moves by kappa times the force
    and never back, beta times the force acts across, to the left for beta > 0.  Where nothing is in the way there is no
    force.  kappa and beta follow from what is left of the wood before the tool, by width and side, from the direction
    to the fibres along x, from the published feeds, from grain, knots, depth and wear.

    It does not model: chatter, forces along z, a plunge's force, heat, splinters, a tool that bends.

    Parameters
    ----------
    rate : float, samples/s, 500 to 1e5

    Others: those of `OakOptions`.

    Source
    ------
    Sörnmo 2015, eqs. (7.4) to (7.10); feeds of Experiment 1, sec. 7.3 (`oak_table`).

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Clamp a fresh piece, and draw its grain."""
        super().__post_init__()
        refuse_rate(self.rate, 500, 1e5, "the simulated oak")
        self._distance, self._grid = _fresh(self)
        self._spots, self._knots = _grown(self)
        self._oak = oak = np.zeros(1, kernel.OAK)
        for name in ("stiffness", "depth", "across", "wear", "knot", "knot_size", "tooth", "runout", "origin"):
            oak[name] = getattr(self, name)
        oak["radius"], oak["turn"], oak["period"] = 0.5 * self.tool, 2 * pi * self.spindle / self.rate, 1.0 / self.rate
        oak["tables"] = drags()

    def run(
        self,
        tool: np.ndarray,
        force: np.ndarray,
        moment: np.ndarray,
        teeth_force: np.ndarray,
        kappa: np.ndarray,
        beta: np.ndarray,
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        tool : array, shape (frames, 3), m
            Where the tip really is, in axes of the base.
        force, moment : arrays, shape (frames, 3), N and N m, filled in place
            On the tool, about its tip, averaged over a turn of the spindle; axes of the base.  There is no moment.
        teeth_force : array, shape (frames, 3), N, filled in place
            The force with its teeth.
        kappa, beta : arrays, shape (frames, 1), m/(N s) and 1, filled in place
            As they are, or were at the last cut.
        """
        told = force, moment, teeth_force, kappa, beta
        kernel.run(tool, told, self._distance, self._grid, self._spots, self._knots, self._oak)

    @property
    def left(self) -> np.ndarray:
        """How far each point is from what is cut, m, > 0 in wood; shape (y, x)."""
        return np.asarray(self._distance[:, :, 0].copy())

    @property
    def milled(self) -> float:
        """The way that the tool has milled, m."""
        return float(self._oak["way"][0])


def _fresh(oak: OakOptions) -> tuple[np.ndarray, np.ndarray]:
    """Return the distances to the piece's own sides, shape (y, x, 1), m, and the grid of `workpiece_kernel`."""
    columns, rows = (ceil(0.5 * side / oak.cell) + 2 for side in (oak.length, oak.width))
    x, y = (np.arange(-n, n + 1) * oak.cell for n in (columns, rows))
    away = np.minimum(0.5 * oak.length - np.abs(x)[None, :], 0.5 * oak.width - np.abs(y)[:, None])
    grid = np.array([(oak.cell, oak.depth, columns * oak.cell, rows * oak.cell)], GRID)
    return away.astype(np.float32)[:, :, None], grid


def _grown(oak: OakOptions) -> tuple[np.ndarray, np.ndarray]:
    """Return the wood's hardness on points `SPOT` apart, shape (y, x), 1, and the knots, shape (n, 2), m."""
    rng = np.random.default_rng([oak.seed, 7])
    columns, rows = (2 * ceil(0.5 * side / kernel.SPOT) + 3 for side in (oak.length, oak.width))
    rough = gaussian_filter(rng.standard_normal((rows, columns)), [each / kernel.SPOT for each in FIBRE[::-1]])
    rough /= max(float(rough.std()), 1e-12)
    places = rng.uniform(-0.5, 0.5, (oak.knots, 2)) * (oak.length, oak.width)
    return np.exp(oak.spread * rough), places
