"""The compiled kernel of oak: what a tool meets, what it removes, and the force that belongs to both."""

import math

import numpy as np
from numba import njit

from firmware_sim.plants.workpiece_kernel import look, sweep

(RADIUS, STIFFNESS, DEPTH, ACROSS, WEAR, KNOT, KNOT_SIZE, TOOTH, RUNOUT, TURN, PERIOD, SETTINGS) = range(12)
"""Of `given`: m, N/m, m, 1, 1/m, 1, m, 1, 1, rad a sample, s."""
DONE, IS_DOWN, WAY, KAPPA, BETA, CELLS = range(6)
"""Of `state`: samples, 0 or 1, m milled, m/(N s), 1."""
RAYS = 48
"""Places along the tool's width before which material is looked for."""
SIGHT = 2e-5
"""m before the tool: material there is touched."""
LEAST = 1e-3
"""Of the tool's width; less is nothing."""
SPOT = 1e-3
"""m between points of the grain's map."""


@njit(cache=True, nogil=True)
def _engaged(x, y, along, distance, grid, radius, found):  # type: ignore[no-untyped-def]
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
def _looked_up(table, cosine, width, left):  # type: ignore[no-untyped-def]
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
def _grain(x, y, spots, knots, given):  # type: ignore[no-untyped-def]
    """Return by what the wood at a place is harder than usual: its map, and the knots."""
    rows, columns = spots.shape
    u = min(max(x / SPOT + 0.5 * (columns - 1), 0.0), columns - 1.001)
    v = min(max(y / SPOT + 0.5 * (rows - 1), 0.0), rows - 1.001)
    i, j = int(v), int(u)
    u, v = u - j, v - i
    hard = (1.0 - v) * ((1.0 - u) * spots[i, j] + u * spots[i, j + 1])
    hard += v * ((1.0 - u) * spots[i + 1, j] + u * spots[i + 1, j + 1])
    for k in range(len(knots)):
        away = ((x - knots[k, 0]) ** 2 + (y - knots[k, 1]) ** 2) / given[KNOT_SIZE] ** 2
        hard *= 1.0 + (given[KNOT] - 1.0) * math.exp(-away * away)
    return hard


@njit(cache=True, nogil=True)
def _remove(at, last, cut, along, distance, grid, tables, spots, knots, given, state, found):  # type: ignore[no-untyped-def]
    """Move `cut` (2,), the tool's place as far as wood is removed, after the tool; return the force, N, along that.

    `at`, `last` (3,) are where the tool is and was, m; `along` (2,) is filled with the direction of the force's pull.
    """
    x, y = at[0] - cut[0], at[1] - cut[1]
    far = math.hypot(x, y)
    if far < 1e-12:
        return 0.0
    along[0], along[1] = x / far, y / far
    width, left = _engaged(cut[0], cut[1], along, distance, grid, given[RADIUS], found)
    if width == 0.0:
        cut[0], cut[1] = at[0], at[1]
        return 0.0
    front = 0.5 * given[RADIUS]
    hard = _grain(cut[0] + front * along[0], cut[1] + front * along[1], spots, knots, given)
    drag = hard * _looked_up(tables[0], along[0], width, left) * (-at[2] / given[DEPTH])
    drag *= (1.0 + given[ACROSS] * along[1] * along[1]) * (1.0 + given[WEAR] * state[WAY])
    state[KAPPA], state[BETA] = 1.0 / drag, _looked_up(tables[1], along[0], width, left)
    before = max((last[0] - cut[0]) * along[0] + (last[1] - cut[1]) * along[1], 0.0)
    moved = (at[0] - last[0]) * along[0] + (at[1] - last[1]) * along[1]
    decay = given[STIFFNESS] * given[PERIOD] / drag
    depth = max(before - math.expm1(-decay) * (moved / decay - before), 0.0)
    state[WAY] += max(far - depth, 0.0)
    cut[0], cut[1] = at[0] - depth * along[0], at[1] - depth * along[1]
    return given[STIFFNESS] * depth


@njit(cache=True, nogil=True)
def run(  # type: ignore[no-untyped-def]
    tool, force, moment, teeth_force, kappa, beta, origin, distance, grid, tables, spots, knots, given, state, places,
):  # fmt: skip
    """Run one frame; signals as in `OakMilling.run`.

    `origin` (3,), m, the middle of the top; `tables` (2, 2, 2, 4) as `oak_table.drags`; `spots` (rows, columns), 1;
    `knots` (n, 2), m; `places` (3, 3): where the tool was, how far wood is removed, and the force's direction.
    """
    at, found = np.empty(3), np.empty(1)
    last, cut, along = places[0], places[1], places[2]
    for n in range(len(tool)):
        for r in range(3):
            at[r] = tool[n, r] - origin[r]
            force[n, r] = moment[n, r] = teeth_force[n, r] = 0.0
        pull = 0.0
        if at[2] < 0.0:
            is_new = state[IS_DOWN] < 0.5
            if is_new:
                cut[:] = at
                last[:] = at
            pull = _remove(at, last, cut, along, distance, grid, tables, spots, knots, given, state, found)
            sweep(distance, grid, cut[0], cut[1], given[RADIUS], 0, 1, is_new)
        state[IS_DOWN] = 1.0 if at[2] < 0.0 else 0.0
        last[:] = at
        turned = state[DONE] * given[TURN]
        ripple = 1.0 + given[TOOTH] * math.sin(2.0 * turned) + given[RUNOUT] * math.sin(turned)
        force[n, 0] = -pull * (along[0] + state[BETA] * along[1])
        force[n, 1] = -pull * (along[1] - state[BETA] * along[0])
        for r in range(2):
            teeth_force[n, r] = ripple * force[n, r]
        kappa[n, 0], beta[n, 0] = state[KAPPA], state[BETA]
        state[DONE] += 1.0
