"""Milling tooth by tooth in a block: any cutting law, teeth that stand out, a tool that rings, hard and soft places."""

from dataclasses import dataclass
from math import ceil, pi, tan

import numpy as np

from firmware_sim.plants import tooth_cut_kernel as kernel
from firmware_sim.plants import tooth_kernel
from firmware_sim.plants.end_mill_kernel import BINS
from firmware_sim.plants.hardness import Hardness
from firmware_sim.plants.milling import DISH
from firmware_sim.plants.milling_kernel import QUEUE, STATE
from firmware_sim.plants.options import refuse_rate
from firmware_sim.plants.workpiece import LARGEST, fresh_block

FINEST = 3e-5
"""s, longest part of a sample."""
A_TOOTH = 24
"""Parts, at least, in which a tooth makes way for the next."""
LOSS = 4e-4
"""s, damping over stiffness of what gives way behind the spindle: 6 % at 50 Hz; assumed, of gears and joints."""


@dataclass(frozen=True)
class CuttingLaw:
    """Force on an edge that takes a chip h, N a m of its width: k h (h / 1 mm)^-m + e; tangential, radial, axial.

    Parameters
    ----------
    strength : (float, float, float), N/m^2, k, at a chip of 1 mm
    power : (float, float, float), 1, m: 0 for a force linear in the chip's area
    edge : (float, float, float), N/m, e
    """

    strength: tuple[float, float, float]
    power: tuple[float, float, float]
    edge: tuple[float, float, float]

    @property
    def table(self) -> np.ndarray:
        """The kernel's rows, shape (3, 3)."""
        return np.array([self.strength, self.power, self.edge])

    def force(self, chip: np.ndarray, direction: int) -> np.ndarray:
        """Return the force on an edge, N a m of its width, same shape as `chip`, m; 0 tangential, 1 radial, 2 axial.

        Parameters
        ----------
        chip : array, any shape, m
        direction : int
        """
        table = self.table
        found = [tooth_kernel.edge_force(each, table, direction) for each in np.ravel(chip)]
        return np.array(found, float).reshape(np.shape(chip))


@dataclass(frozen=True)
class ToolMode:
    """A tool that rings beside where its spindle is: Hz, 1 and N/m, along x and y each."""

    frequency: tuple[float, float]
    damping: tuple[float, float]
    stiffness: tuple[float, float]


@dataclass(frozen=True)
class ToothCut:
    """A cut, as numbers.

    Parameters
    ----------
    law : CuttingLaw
    tool : float, m, diameter
    wobble : tuple of float, m
        By how much each tooth stands out; one each.
    spindle : float, Hz
    helix : float, rad
    mode : ToolMode or None
    mass : float, kg, of the spindle, which what gives way behind it must move
    across : float, 1, by what it is harder across x, in excess
    is_averaged : bool
        Whether forces are told as their mean over a turn; else as they are in each sample.
    hardness : Hardness
    length, width, thickness : float, m, of the block
    cell, layer : float, m, of its grid
    origin : (float, float, float), m, the middle of the block's top in the base
    seed : int, of the block
    """

    law: CuttingLaw
    tool: float
    wobble: tuple[float, ...]
    spindle: float
    helix: float
    mode: ToolMode | None
    mass: float
    across: float
    is_averaged: bool
    hardness: Hardness
    length: float
    width: float
    thickness: float
    cell: float
    layer: float
    origin: tuple[float, float, float]
    seed: int


class ToothCutPlant:
    """An end mill along -z, turning clockwise seen from above, in a block whose top is at z = 0.

    A tooth's chip is from where it is down to the deepest that the last dozen teeth have cut in its direction, so
    a tool that rings cuts its own waves again (regenerative chatter), and a tooth that leaves the wave cuts nothing.
    The tool rings beside the spindle, the spindle's mass on what gives way at once behind it, as the robot tells; the
    robot is pulled by that, not by the teeth.  What is left of the block is remembered as in `PocketMilling`.

    It does not model: a tool that tilts, chips that are cut again, heat, process damping by worn flanks, the wave that
    is left in a wall.

    Parameters
    ----------
    rate : float, samples/s, 500 to 1e5
    cut : ToothCut

    Source
    ------
    Tlusty and Ismail, Ann. CIRP 30 (1981) 299; Altintas, Manufacturing Automation, 2nd ed., sec. 2.8 and 4.5; Kienzle,
    VDI-Z 94 (1952) 299.

    Raises
    ------
    ValueError : the block has too many points.
    """

    def __init__(self, rate: float, cut: ToothCut) -> None:
        refuse_rate(rate, 500, 1e5, "the simulated cut")
        points = cut.length * cut.width * cut.thickness / (cut.cell**2 * cut.layer)
        if points > LARGEST:
            raise ValueError(f"the block has {points:.3g} points, must be at most {LARGEST:.3g}")
        self.cut = cut
        self._arrays = _arrays(cut, rate)

    def run(
        self,
        tool: np.ndarray,
        give: np.ndarray,
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
            Where the tip really is, in axes of the base, with the force of the sample before on it.
        give : array, shape (frames, 9), m/N
            By what the tip moves at once for a force, a 3 x 3 matrix row by row; zeros for a tool on rails.
        force, moment : arrays, shape (frames, 3), N and N m, filled in place
            On the robot, about the tip; axes of the base.
        teeth_force : array, shape (frames, 3), N, filled in place
            On the teeth.
        kappa, beta : arrays, shape (frames, 1), m/(N s) and 1, filled in place
            The feed over the teeth's force against it, and their force to its left over that; means over a turn, or as
            they were at the last cut.
        """
        kernel.run(tool, give, (force, moment, teeth_force, kappa, beta), self._arrays)

    @property
    def ringing(self) -> np.ndarray:
        """How far the tool is beside its spindle, x and y, shape (2,), m."""
        return np.asarray(self._arrays.ringing[tooth_kernel.PLACE].copy())


def _arrays(cut: ToothCut, rate: float) -> kernel.Cut:
    """Return the kernel's arrays of a fresh block."""
    rng = np.random.default_rng([cut.seed, 9])
    teeth, layers = len(cut.wobble), max(1, round(cut.thickness / cut.layer))
    parts = ceil(max(1.0 / (rate * FINEST), A_TOOTH * teeth * cut.spindle / rate) - 1e-9)
    period = 1.0 / (rate * parts)
    angles = 2 * pi * (np.arange(BINS) + 0.5) / BINS
    distance, grid = fresh_block(cut.length, cut.width, cut.thickness, cut.cell, cut.layer)
    tooth, span = 1.0 / (cut.spindle * teeth * period), max(1.0, rate / cut.spindle)
    given = np.array([(
        0.5 * cut.tool, teeth, 2 * pi * cut.spindle * period, tan(cut.helix), parts, tooth, tan(DISH), span, period,
        cut.mass, LOSS, cut.is_averaged, cut.across, grid["layer"][0], cut.law.table,
    )], tooth_kernel.CUTTER)  # fmt: skip
    kept = np.zeros(1, kernel.KEPT)
    kept["angle"] = rng.uniform(0, 2 * pi)
    return kernel.Cut(
        origin=np.array(cut.origin, float), distance=distance, grid=grid,
        spots=cut.hardness.grown(cut.seed, cut.length, cut.width),
        wobble=np.array(cut.wobble, float), around=np.column_stack([np.cos(angles), np.sin(angles)]), given=given,
        mode=_mode(cut.mode, period), state=np.zeros(1, STATE), queue=np.zeros((QUEUE, 4)),
        width=np.zeros((BINS, 1 + layers)), found=np.zeros(layers), hard=np.ones(BINS),
        past=np.zeros((ceil(kernel.PASSES * tooth) + 3, 3)), ringing=np.zeros((2, 2)),
        hanging=np.zeros((2, 3)), motion=np.zeros((3, 3)), turns=np.zeros((ceil(span), 12)),
        kept=kept,
    )  # fmt: skip


def _mode(mode: ToolMode | None, period: float) -> np.ndarray:
    """Return the kernel's recursion of a tool's mode, shape (2, 6); of one that does not move where there is none."""
    table = np.zeros((2, 6))
    if mode is None:
        return table
    for axis in range(2):
        omega, damping = 2 * pi * mode.frequency[axis], mode.damping[axis]
        mass = mode.stiffness[axis] / omega**2
        decay, ringing = damping * omega, omega * np.sqrt(1 - damping**2)
        shrink, cosine = np.exp(-decay * period), np.cos(ringing * period)
        sine = np.sin(ringing * period) / ringing
        free = shrink * (cosine + decay * sine)
        table[axis] = (
            free, shrink * sine, -(omega**2) * shrink * sine, shrink * (cosine - decay * sine),
            (1 - free) / mode.stiffness[axis], shrink * sine / mass,
        )  # fmt: skip
    return table
