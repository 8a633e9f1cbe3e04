"""The compiled kernel of oak: what a tool meets, what it removes, and the force that belongs to both."""

import math

import numpy as np

from firmware_sim.plants.record import Record
from firmware_sim.plants.workpiece_kernel import look, sweep
from rigkit.compiled import njit

OAK = np.dtype(
    [
        ("radius", "f8"),  # m
        ("stiffness", "f8"),  # N/m
        ("depth", "f8"),  # m
        ("across", "f8"),  # 1
        ("wear", "f8"),  # 1/m
        ("knot", "f8"),  # 1
        ("knot_size", "f8"),  # m
        ("tooth", "f8"),  # 1
        ("runout", "f8"),  # 1
        ("turn", "f8"),  # rad a sample
        ("period", "f8"),  # s
        ("origin", "f8", 3),  # m, the middle of the top
        ("tables", "f8", (2, 2, 2, 4)),  # as `oak_table.drags`
        # state
        ("done", "i8"),  # samples
        ("is_down", "?"),
        ("way", "f8"),  # m milled
        ("kappa", "f8"),  # m/(N s)
        ("beta", "f8"),  # 1
        ("last", "f8", 3),  # m, where the tool was
        ("cut", "f8", 3),  # m, how far wood is removed
        ("along", "f8", 3),  # the direction of the force's pull
    ],
    align=True,
)
RAYS = 48
"""Places along the tool's width before which material is looked for."""
SIGHT = 2e-5
"""m before the tool: material there is touched."""
LEAST = 1e-3
"""Of the tool's width; less is nothing."""
SPOT = 1e-3
"""m between points of the grain's map."""


@njit(cache=True, nogil=True)
def _engaged(
    x: float, y: float, along: np.ndarray, distance: np.ndarray, grid: Record, radius: float, found: np.ndarray
) -> tuple[float, float]:
    """Return the part of the tool's width that meets material in direction `along` (2,), and how far left it lies.

    The latter is 1 where all of it is on the left, -1 on the right.
    """
    width = moment = 0.0
    for ray in range(RAYS):
        sine = (2.0 * ray + 1.0) / RAYS - 1.0
        ahead, aside = (radius + SIGHT) * math.sqrt(1.0 - sine * sine), (radius + SIGHT) * sine
        at_x, at_y = x + ahead * along[0] - aside * along[1], y + ahead * along[1] + aside * along[0]
        look(distance, grid, at_x, at_y, 0, 1, found)
        touching = min(max(found[0] / SIGHT, 0.0), 1.0) / RAYS
        width += touching
        moment += touching * sine
    if width < LEAST:
        return 0.0, 0.0
    room = max(1.0 - width, 1e-3)
    return width, min(max(moment / width / room, -1.0), 1.0)


@njit(cache=True, nogil=True)
def _looked_up(table: np.ndarray, cosine: float, width: float, left: float) -> float:
    """Interpolate `table` (2, 2, 4) in direction, hand and width."""
    third = min(int(3.0 * width), 2)
    part = 3.0 * width - third
    forth, up = 0.5 * (1.0 + cosine), 0.5 * (1.0 + left)
    value = 0.0
    for way in range(2):
        for hand in range(2):
            share = (forth if way == 0 else 1.0 - forth) * (up if hand == 0 else 1.0 - up)
            value += share * ((1.0 - part) * table[way, hand, third] + part * table[way, hand, third + 1])
    return value


@njit(cache=True, nogil=True)
def _grain(x: float, y: float, spots: np.ndarray, knots: np.ndarray, oak: Record) -> float:
    """Return by what the wood at a place is harder than usual: its map, and the knots."""
    rows, columns = spots.shape
    u = min(max(x / SPOT + 0.5 * (columns - 1), 0.0), columns - 1.001)
    v = min(max(y / SPOT + 0.5 * (rows - 1), 0.0), rows - 1.001)
    i, j = int(v), int(u)
    u, v = u - j, v - i
    hard = (1.0 - v) * ((1.0 - u) * spots[i, j] + u * spots[i, j + 1])
    hard += v * ((1.0 - u) * spots[i + 1, j] + u * spots[i + 1, j + 1])
    for k in range(len(knots)):
        away = ((x - knots[k, 0]) ** 2 + (y - knots[k, 1]) ** 2) / oak.knot_size**2
        hard *= 1.0 + (oak.knot - 1.0) * math.exp(-away * away)
    return float(hard)


@njit(cache=True, nogil=True)
def _remove(
    at: np.ndarray,
    distance: np.ndarray,
    grid: Record,
    spots: np.ndarray,
    knots: np.ndarray,
    oak: Record,
    found: np.ndarray,
) -> float:
    """Move the place as far as which wood is removed after the tool, which is `at` (3,), m; return the force, N."""
    last, cut, along = oak.last, oak.cut, oak.along
    x, y = at[0] - cut[0], at[1] - cut[1]
    far = math.hypot(x, y)
    if far < 1e-12:
        return 0.0
    along[0], along[1] = x / far, y / far
    width, left = _engaged(cut[0], cut[1], along, distance, grid, oak.radius, found)
    if width == 0.0:
        cut[0], cut[1] = at[0], at[1]
        return 0.0
    front = 0.5 * oak.radius
    hard = _grain(cut[0] + front * along[0], cut[1] + front * along[1], spots, knots, oak)
    drag = hard * _looked_up(oak.tables[0], along[0], width, left) * (-at[2] / oak.depth)
    drag *= (1.0 + oak.across * along[1] * along[1]) * (1.0 + oak.wear * oak.way)
    oak.kappa, oak.beta = 1.0 / drag, _looked_up(oak.tables[1], along[0], width, left)
    before = max((last[0] - cut[0]) * along[0] + (last[1] - cut[1]) * along[1], 0.0)
    moved = (at[0] - last[0]) * along[0] + (at[1] - last[1]) * along[1]
    decay = oak.stiffness * oak.period / drag
    depth = max(before - math.expm1(-decay) * (moved / decay - before), 0.0)
    oak.way += max(far - depth, 0.0)
    cut[0], cut[1] = at[0] - depth * along[0], at[1] - depth * along[1]
    return float(oak.stiffness * depth)


@njit(cache=True, nogil=True)
def run(
    tool: np.ndarray,
    told: tuple[np.ndarray, ...],
    distance: np.ndarray,
    grids: np.ndarray,
    spots: np.ndarray,
    knots: np.ndarray,
    oaks: np.ndarray,
) -> None:
    """Run one frame; signals as in `OakMilling.run`.

    `spots` (rows, columns), 1; `knots` (n, 2), m; `oaks` is of one `OAK`.
    """
    (force, moment, teeth_force, kappa, beta), grid, oak = told, grids[0], oaks[0]
    at, found = np.empty(3), np.empty(1)
    last, cut, along = oak.last, oak.cut, oak.along
    for n in range(len(tool)):
        for r in range(3):
            at[r] = tool[n, r] - oak.origin[r]
            force[n, r] = moment[n, r] = teeth_force[n, r] = 0.0
        pull = 0.0
        if at[2] < 0.0:
            is_new = not oak.is_down
            if is_new:
                cut[:] = at
                last[:] = at
            pull = _remove(at, distance, grid, spots, knots, oak, found)
            sweep(distance, grid, cut[0], cut[1], oak.radius, 0, 1, is_new)
        oak.is_down = at[2] < 0.0
        last[:] = at
        turned = oak.done * oak.turn
        ripple = 1.0 + oak.tooth * math.sin(2.0 * turned) + oak.runout * math.sin(turned)
        force[n, 0] = -pull * (along[0] + oak.beta * along[1])
        force[n, 1] = -pull * (along[1] - oak.beta * along[0])
        for r in range(2):
            teeth_force[n, r] = ripple * force[n, r]
        kappa[n, 0], beta[n, 0] = oak.kappa, oak.beta
        oak.done += 1
