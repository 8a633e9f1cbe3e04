"""Cuts drawn by seed: what law the force of a tooth follows, and what stands in its way."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from firmware_sim.plants.hardness import Hardness
from firmware_sim.plants.stability_lobes import depth_limit
from firmware_sim.plants.tooth_cut import CuttingLaw, ToolMode, ToothCut
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams

FAMILIES = ("linear", "power", "teeth", "chatter", "oak", "boards")
"""Linear in the chip's area; Kienzle's power with an edge's force; teeth that stand out; a tool that rings; wood with
grain and knots; boards of other hardness side by side."""
DEPTH, TOOL, FEED = 2e-3, 6e-3, 10e-3
"""m, m and m/s of the slot whose force is drawn: a program's default pocket."""
FORCE, SHARE = (1.0, 60.0), (0.25, 1.0)
"""N in the plane, in that slot, and that over the most that is within the arm's reach."""
WITHIN = 0.7
"""1: a cut's depth over the one from which on the arm itself chatters, at most; nobody mills what shakes the robot."""
ATTEMPTS = 12
STEEPEST = 2e9
"""N/m^2, of the hardest place, force over chip's area as the chip grows: structural steel."""
TEETH, SPINDLE, HELIX = (2, 4), (180.0, 600.0), (0.3, 0.7)
"""Count, Hz and rad."""
RADIAL, AXIAL = (0.2, 0.5), (0.05, 0.3)
"""Over the tangential force."""
EDGE, POWER = (0.0, 0.6), (0.15, 0.4)
"""Part of the slot's force that rubs, and Kienzle's m."""
RUNOUT = 2e-6, 30e-6
"""m, by which the tool turns beside its own axis."""
MODE, MODE_DAMPING, BESIDE = (250.0, 900.0), (0.01, 0.04), (0.9, 1.1)
"""Hz and 1 along x; the frequency along y over that."""
OVER_LIMIT = 0.3, 2.5
"""1: the slot's depth over the one from which on it chatters."""
GRAIN, KNOTS, KNOT, KNOT_SIZE, ACROSS = (0.05, 0.3), (1, 6), (1.5, 3.0), (2e-3, 5e-3), (0.0, 0.5)
BOARDS, HARDER = (2, 4), (0.3, 8.0)
"""Count, and by what each but the first is harder."""
SCATTER = 0.08
"""1, largest standard deviation from piece to piece."""
CELL, LAYER = 2e-4, 5e-4
"""m, of the grid in which a piece is remembered."""
SHALLOW = 0.3
"""Of the thickest chip: the one at which a law's steepness is taken."""
ANGLES = 100
"""Of half a turn, over which a slot's force is summed."""
PIECES = 1_000_003
"""Pieces of a cut before they could be those of another."""


@dataclass(frozen=True)
class DrawnCut:
    """A cut.

    Parameters
    ----------
    cut : ToothCut
        Its piece is the first one, in the middle of the base.
    family : str
    force : float, N
        Mean in the plane, in a slot of `DEPTH` at `FEED`.
    rubbing : float, 1
        The part of it that does not grow with the feed.
    over_limit : float, 1
        The slot's depth over the one from which on it chatters; 0 where nothing rings.
    """

    cut: ToothCut
    family: str
    force: float
    rubbing: float
    over_limit: float

    def piece(self, seed: int, hardness: float) -> ToothCut:
        """Return one of its pieces, by its seed and by what it is harder, 1."""
        law = self.cut.law
        harder = replace(law, strength=_scaled(law.strength, hardness), edge=_scaled(law.edge, hardness))
        return replace(self.cut, law=harder, seed=PIECES * self.cut.seed + seed)


def draw_cut(streams: Streams, seed: int, family: str, mass: float, arm: Sequence[ToolMode]) -> DrawnCut:
    """Draw a cut that a robot can bear.

    Teeth and spindle are drawn again, from the next streams, until some force is within reach of the arm; where none of
    them allows that, they are those of which most is.

    Parameters
    ----------
    streams : Streams
    seed : int
    family : str, of `FAMILIES`
    mass : float, kg, of the spindle
    arm : sequence of ToolMode
        How the spindle rings on the arm where it mills.
    """
    hardness, power = _hardness(streams, family), 0.0
    across = float(streams("across").uniform(*ACROSS)) if family == "oak" else 0.0
    if family in ("power", "oak"):
        power = float(streams("power").uniform(*POWER))
    rubbing = 0.0 if family in ("chatter", "oak") else float(streams("edge").uniform(*EDGE))
    shares = 1.0, float(streams("radial").uniform(*RADIAL)), float(streams("axial").uniform(*AXIAL))
    hardest, reach, turning = _hardest(hardness) * (1.0 + across), 0.0, (0, 0.0)
    for attempt in range(ATTEMPTS):
        tried = _turning(streams.within(f"attempt {attempt}"))
        found = _reach(_law(shares, power, 1.0, rubbing, tried), tried, arm) / hardest
        if found > reach:
            turning, reach = tried, found
        if reach >= FORCE[0] / SHARE[0]:
            break
    law = _law(shares, power, min(reach, FORCE[1]) * _drawn(streams, "force", SHARE), rubbing, turning)
    teeth, spindle = turning
    mode, over_limit = None, 0.0
    if family == "chatter":
        over_limit = _drawn(streams, "depth over limit", OVER_LIMIT)
        mode = _mode(streams, law, teeth, spindle, over_limit)
    cut = ToothCut(
        law=law, tool=TOOL, wobble=_wobble(streams, teeth, family), spindle=spindle,
        helix=0.0 if family == "chatter" else float(streams("helix").uniform(*HELIX)), mode=mode, mass=mass,
        across=across, is_averaged=False, hardness=hardness, length=50e-3, width=50e-3,
        thickness=6e-3, cell=CELL, layer=LAYER, origin=(0.0, 0.0, 0.0), seed=seed,
    )  # fmt: skip
    return DrawnCut(cut, family, float(np.hypot(*slot_force(law, *turning, FEED, DEPTH))), rubbing, over_limit)


def slot_force(law: CuttingLaw, teeth: int, spindle: float, feed: float, depth: float) -> tuple[float, float]:
    """Return the mean force on the tool over a turn in a slot, N: along the feed, and to its left.

    Parameters
    ----------
    law : CuttingLaw
    teeth : int
    spindle : float, Hz
    feed : float, m/s
    depth : float, m
    """
    angle = np.pi * ((np.arange(ANGLES) + 0.5) / ANGLES - 0.5)
    x, y = np.cos(angle), np.sin(angle)
    tangential, radial = (law.force(feed / (teeth * spindle) * x, way) for way in range(2))
    size = 0.5 * depth * teeth
    along, left = size * np.mean(-tangential * y - radial * x), size * np.mean(tangential * x - radial * y)
    return float(along), float(left)


def _turning(streams: Streams) -> tuple[int, float]:
    """Return teeth and the spindle's speed, Hz."""
    return int(streams("teeth").integers(TEETH[0], TEETH[1] + 1)), _drawn(streams, "spindle", SPINDLE)


def _reach(law: CuttingLaw, turning: tuple[int, float], arm: Sequence[ToolMode]) -> float:
    """Return by what a law's force may be multiplied for the arm to be below its own limit of chatter, and no steel."""
    chip = SHALLOW * FEED / (turning[0] * turning[1])
    steep = float(np.diff(law.force(np.array([0.9, 1.1]) * chip, 0))[0] / (0.2 * chip))
    radial = law.strength[1] / law.strength[0]
    return min(STEEPEST / steep, *(WITHIN * depth_limit(mode, steep, radial, *turning) / DEPTH for mode in arm))


def _hardest(hardness: Hardness) -> float:
    """Return by what the hardest places of a piece are harder, 1; of grain, nine of ten."""
    knot = hardness.knot if hardness.knots else 1.0
    return float(max(1.0, *hardness.boards) * knot * np.exp(1.3 * hardness.grain))


def _drawn(streams: Streams, name: str, limits: tuple[float, float]) -> float:
    return float(log_uniform(streams(name), *limits))


def _scaled(three: tuple[float, float, float], factor: float) -> tuple[float, float, float]:
    first, second, third = three
    return factor * first, factor * second, factor * third


def _law(
    shares: tuple[float, float, float], power: float, force: float, rubbing: float, turning: tuple[int, float]
) -> CuttingLaw:
    """Return the law with which the slot takes `force`, of which the part `rubbing` is the edges'."""
    nothing = 0.0, 0.0, 0.0
    cutting, edges = CuttingLaw(shares, (power,) * 3, nothing), CuttingLaw(nothing, nothing, shares)
    wanted = (1.0 - rubbing) * force, rubbing * force
    whole = [np.hypot(*slot_force(each, *turning, FEED, DEPTH)) for each in (cutting, edges)]
    strength, edge = (_scaled(shares, float(part / one)) for part, one in zip(wanted, whole, strict=True))
    return CuttingLaw(strength, (power,) * 3, edge)


def _wobble(streams: Streams, teeth: int, family: str) -> tuple[float, ...]:
    if family != "teeth":
        return (0.0,) * teeth
    runout, first = _drawn(streams, "runout", RUNOUT), streams("first tooth").uniform(0.0, 2 * np.pi)
    return tuple((runout * np.cos(2 * np.pi * np.arange(teeth) / teeth + first)).tolist())


def _mode(streams: Streams, law: CuttingLaw, teeth: int, spindle: float, over_limit: float) -> ToolMode:
    """Draw a tool whose slot chatters from the depth on that is wanted: the limit is proportional to its stiffness."""
    along, damping = _drawn(streams, "tool's mode", MODE), streams("tool's damping")
    frequency = along, along * float(streams("beside").uniform(*BESIDE))
    ratios = float(log_uniform(damping, *MODE_DAMPING)), float(log_uniform(damping, *MODE_DAMPING))
    beside = float(log_uniform(streams("stiffness across"), 0.5, 2.0))
    unit = ToolMode(frequency, ratios, (1e6, 1e6 * beside))
    limit = depth_limit(unit, law.strength[0], law.strength[1] / law.strength[0], teeth, spindle)
    stiffness = 1e6 * DEPTH / (over_limit * limit)
    return replace(unit, stiffness=(stiffness, beside * stiffness))


def _hardness(streams: Streams, family: str) -> Hardness:
    scatter = float(streams("scatter").uniform(0.0, SCATTER))
    if family == "oak":
        knots = streams("knots")
        return Hardness(
            grain=float(streams("grain").uniform(*GRAIN)), knots=int(knots.integers(KNOTS[0], KNOTS[1] + 1)),
            knot=float(knots.uniform(*KNOT)), knot_size=float(knots.uniform(*KNOT_SIZE)), scatter=scatter,
        )  # fmt: skip
    if family == "boards":
        boards = streams("boards")
        others = log_uniform(boards, *HARDER, int(boards.integers(*BOARDS)))
        heading = float(boards.uniform(0.0, np.pi))
        return Hardness(boards=(1.0, *others.tolist()), heading=heading, scatter=scatter)
    return Hardness(scatter=scatter)
