"""Milling a block with an end mill: the force on the tool follows from what is really left of the block."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi, tan

import numpy as np

from firmware_sim.plants import end_mill_kernel as mill
from firmware_sim.plants import milling_kernel as kernel
from firmware_sim.plants.cutting_force import MATERIALS
from firmware_sim.plants.options import choice, option, refuse_rate, refuse_wrong_options
from firmware_sim.plants.workpiece import LARGEST, fresh_block

FASTEST_TURN = 2 * pi / 72
"""rad by which the tool turns at most between two looks at its teeth."""
HARDNESS = 0.03
"""Relative standard deviation of the force from block to block, cut off at two of it; assumed."""
DISH = np.deg2rad(2.0)
"""rad, by which the edges below the tool are hollow: end mills have 1 to 3 degrees."""


@dataclass(eq=False, kw_only=True)
class PocketOptions:
    """Which block, which tool; defaults of Sörnmo 2015, sec. 5.3, with the spindle at its fastest.

    Parameters
    ----------
    material : "al7075", "al7075-hss" or "al6082"
    seed : int
        Draws the block's hardness, and how tool and spindle stand at first.
    tool : float, m, diameter
    teeth : int
    spindle : float, Hz
    helix : float, rad
    runout : float, m, by which the tool turns beside its own axis
    wear : float, 1, scales the forces of the edges; 1 for a sharp tool
    spread : float, 1, scales how far blocks differ
    length, width, thickness : float, m, of the block, along x, y and z
    cell, layer : float, m, of the block's grid
    origin : sequence of float, m, 3, the middle of the block's top in the base

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    material: str = choice(*MATERIALS)
    seed: int = option(1, "", 0)
    tool: float = option(6e-3, "m", 1e-3, 0.02)
    teeth: int = option(2, "", 1, 8)
    spindle: float = option(22_000 / 60, "Hz", 10.0, 1_000.0)
    helix: float = option(0.5236, "rad", 0.0, 1.0)
    runout: float = option(2e-6, "m", 0.0, 1e-4)
    wear: float = option(1.0, "1", 0.0, 10.0)
    spread: float = option(1.0, "1", 0.0, 3.0)
    length: float = option(50e-3, "m", 1e-3, 0.5)
    width: float = option(50e-3, "m", 1e-3, 0.5)
    thickness: float = option(6e-3, "m", 1e-4, 0.05)
    cell: float = option(1e-4, "m", 2e-5, 5e-4)
    layer: float = option(2.5e-4, "m", 5e-5, 1e-2)
    origin: Sequence[float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)
        if not (len(self.origin) == 3 and np.all(np.isfinite(self.origin))):
            raise ValueError(f"simulator.options.origin is {self.origin!r}, must be 3 numbers, m")
        points = self.length * self.width * self.thickness / (self.cell**2 * self.layer)
        if points > LARGEST:
            raise ValueError(
                f"the block has {points:.3g} points, must be at most {LARGEST:.3g}: "
                "simulator.options.length, width, thickness over cell, cell, layer"
            )


@dataclass(eq=False)
class PocketMilling(PocketOptions):
    """An end mill along -z, turning clockwise seen from above, in a block whose top is at z = 0.

    What the tool reaches is gone, to some 0.1 um across walls and half a layer in depth; how much of each tooth cuts
    follows from what is left, and the chip from the tool's speed as it is.  So slots, contours, finishing and cuts
    through air behave, and a tool that gives way takes less.  A tooth's forces are those of `CuttingForce`, along its
    helix; runout makes teeth differ.  Edges below the tool cut where it comes down more steeply than they are hollow.

    Speed and mean force are found together, sample by sample, for a tool that gives way to a force at once by what it
    is told; else a robot whose tool does so would shake.  The force must reach the robot one sample late.

    It does not model: chatter (a chip does not know the wave that the tooth before has left), a tool that tilts or
    bends, chips that are cut again, heat, built-up edges, size effects of thin chips, a floor that springs back; a
    floor that is crossed again lower by less than half a layer is felt as new.

    Parameters
    ----------
    rate : float, samples/s, 1000 to 1e5

    Others: those of `PocketOptions`.

    Source
    ------
    Altintas, Manufacturing Automation, 2nd ed., sec. 2.8; Sörnmo 2015, sec. 5.3.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Clamp a fresh block, and draw what differs from one to the next."""
        super().__post_init__()
        refuse_rate(self.rate, 1_000, 1e5, "the simulated cut")
        rng = np.random.default_rng([self.seed, 5])
        hardness = 1.0 + self.spread * HARDNESS * np.clip(rng.standard_normal(), -2, 2)
        strength = hardness * MATERIALS[self.material].table
        strength[1] *= self.wear
        places = 2 * pi * (np.arange(self.teeth) / self.teeth) + rng.uniform(0, 2 * pi)
        turned = np.zeros(1, mill.TURNED)
        turned["angle"] = rng.uniform(0, 2 * pi)
        angles = 2 * pi * (np.arange(mill.BINS) + 0.5) / mill.BINS
        distance, grid = fresh_block(self.length, self.width, self.thickness, self.cell, self.layer)
        given, layers = _given(self, grid), distance.shape[2]
        self._cut = kernel.Cut(
            origin=np.array(self.origin, float), distance=distance, grid=grid, hardness=strength,
            wobble=self.runout * np.cos(places), around=np.column_stack([np.cos(angles), np.sin(angles)]), given=given,
            state=np.zeros(1, kernel.STATE), turned=turned, queue=np.zeros((kernel.QUEUE, 4)), motion=np.zeros((4, 3)),
            ring=np.zeros((given["span"][0], 3)), width=np.zeros((mill.BINS, 1 + layers)), found=np.zeros(layers),
        )  # fmt: skip

    def run(
        self, tool: np.ndarray, give: np.ndarray, force: np.ndarray, moment: np.ndarray, teeth_force: np.ndarray
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        tool : array, shape (frames, 3), m
            Where the tip really is, in axes of the base, with the force of the sample before on it.
        give : array, shape (frames, 9), m/N
            By what the tip moves at once for a force, a 3 x 3 matrix row by row; zeros for a tool on rails.
        force, moment : arrays, shape (frames, 3), N and N m, filled in place
            On the tool, about its tip, averaged over a turn of the spindle; axes of the base.
        teeth_force : array, shape (frames, 3), N, filled in place
            The force with its teeth, averaged over each sample.
        """
        kernel.run(tool, give, force, moment, teeth_force, self._cut)

    @property
    def chips(self) -> float:
        """The chips so far, m^3, as the teeth have cut them."""
        return float(self._cut.turned["chips"][0])

    @property
    def taken(self) -> float:
        """What is gone of the block, m^3; it lags the tool by `milling_kernel.LAG`."""
        share = np.clip(0.5 - self._cut.distance / self.cell, 0.0, 1.0)
        inside = fresh_block(self.length, self.width, self.thickness, self.cell, self.layer)[0] > 0.0
        return float(share[inside].sum(dtype=float) * self.cell**2 * self._cut.grid["layer"][0])

    def section(self, depth: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return x, y (m) and, shape (y, x), how far each point is from the walls at `depth` (m): > 0 in material."""
        layer = min(max(int(depth / self._cut.grid["layer"][0]), 0), self._cut.distance.shape[2] - 1)
        rows, columns = self._cut.distance.shape[:2]
        (_, _, left, low), cell = self._cut.grid[0], self.cell
        x, y = np.arange(columns) * cell - left, np.arange(rows) * cell - low
        return x, y, self._cut.distance[:, :, layer].copy()


def _given(cut: PocketMilling, grid: np.ndarray) -> np.ndarray:
    """Return the kernel's settings, of one `MILL`."""
    given, turn = np.zeros(1, mill.MILL), 2 * pi * cut.spindle / cut.rate
    given["radius"], given["teeth"], given["turn"], given["helix"] = 0.5 * cut.tool, cut.teeth, turn, tan(cut.helix)
    given["substeps"], given["tooth"] = max(1, ceil(turn / FASTEST_TURN)), 1.0 / (cut.teeth * cut.spindle)
    given["dish"], given["span"] = tan(DISH), max(1, round(cut.rate / cut.spindle))
    given["period"], given["layer"] = 1.0 / cut.rate, grid["layer"]
    return given
