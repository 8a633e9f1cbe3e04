"""The pocket's rounds: where the tool's tip is wanted in the workpiece."""

import numpy as np

from stagectl.experiments.trials.rounded_path import rounded
from stagectl.experiments.trials.tool_path import RATE, ToolPath
from stagectl.robot.pocket_config import Pocket
from stagectl.robot.tool_path import ramped

OVERLAP = 3e-3
"""m that the last round goes on over its own beginning."""


def pocket_path(pocket: Pocket) -> ToolPath:
    """Return the path: down over the innermost round, that one at depth, outwards round by round, off the wall, out.

    Rounds run counterclockwise seen from above: with a spindle that turns clockwise the tool climbs.

    Parameters
    ----------
    pocket : Pocket
    """
    points, way = rounded(corners(pocket), pocket.corner)
    seconds = float(way[-1]) / pocket.feed
    samples = int(np.ceil((pocket.lead + seconds + pocket.ramp + pocket.tail) * RATE))
    gone = pocket.feed * ramped(np.arange(samples) / RATE - pocket.lead, seconds, pocket.ramp)
    return ToolPath(pocket, np.stack([np.interp(gone, way, each) for each in points.T], axis=-1))


def corners(pocket: Pocket) -> np.ndarray:
    """Return begin, corners and end of the path, shape (corners, 3), m: x and y from the middle, z from the surface up.

    Parameters
    ----------
    pocket : Pocket
    """
    rounds, deep = _rounds(pocket), -pocket.depth
    found = _descent(rounds[0], pocket)
    for half in rounds:
        found += [(0.0, -half[1], deep), *((x, y, deep) for x, y in _round(half)), (0.0, -half[1], deep)]
    outer = rounds[-1]
    found.append((min(OVERLAP, 0.5 * outer[0]), -outer[1], deep))
    inwards = 0.5 * min(pocket.step, pocket.tool)
    off = (found[-1][0] + inwards, -outer[1] + inwards)
    return np.array([*found, (*off, deep), (*off, pocket.clearance)])


def _rounds(pocket: Pocket) -> list[tuple[float, float]]:
    """Return half the sides of each round, m, from the innermost on."""
    half = tuple(0.5 * (side - pocket.tool) for side in pocket.size)
    inwards = int((min(half) - 2 * pocket.corner) / pocket.step)
    return [(half[0] - k * pocket.step, half[1] - k * pocket.step) for k in range(inwards, -1, -1)]


def _descent(half: tuple[float, float], pocket: Pocket) -> list[tuple[float, float, float]]:
    """Return rounds of half sides `half` that go down from the clearance to the depth, without their last point."""
    one = [(0.0, -half[1]), *_round(half)]
    drop, around = pocket.clearance + pocket.depth, 4.0 * (half[0] + half[1])
    flat = np.array([*one * int(np.ceil(drop / (pocket.slope * around))), one[0]])
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(flat, axis=0), axis=1))])
    height = pocket.clearance - drop * way / way[-1]
    return [(float(x), float(y), float(z)) for (x, y), z in zip(flat[:-1], height[:-1], strict=True)]


def _round(half: tuple[float, float]) -> list[tuple[float, float]]:
    x, y = half
    return [(x, -y), (x, y), (-x, y), (-x, -y)]
