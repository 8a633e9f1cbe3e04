"""The compiled kernel of an end mill in a block: it takes material, touches what is left, and is pushed by that."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from firmware_sim.plants.end_mill_kernel import BINS, MASS, PERIOD, RADIUS, SPAN, ends, is_sinking, meet, turn
from firmware_sim.plants.workpiece_kernel import LAYER, look, sweep, swept_layers

DONE, WAY, HEAD, TAIL, LAYERS, CELLS = range(6)
"""Of `state`: samples, m, the queue's ends, layers taken at the last sweep."""
STEP, LAG = 5e-6, 1e-4
"""m: a place of the tool is taken out of the block when the tool has come `LAG` further; places are `STEP` apart."""
QUEUE = 64
TOUCH = 2e-6
"""m of material before an edge that counts as a full engagement."""


@njit(cache=True, nogil=True)
def take(at, distance, grid, given, state, queue):  # type: ignore[no-untyped-def]
    """Queue the tool's place `at` (3,), m, and take out of the block where it was `LAG` ago; `queue` (QUEUE, 4)."""
    newest = queue[int(state[HEAD]) % QUEUE]
    moved = math.sqrt((at[0] - newest[0]) ** 2 + (at[1] - newest[1]) ** 2 + (at[2] - newest[2]) ** 2)
    if moved < STEP:
        return
    state[WAY] += moved
    state[HEAD] += 1.0
    into = queue[int(state[HEAD]) % QUEUE]
    into[:3] = at
    into[3] = state[WAY]
    while state[TAIL] < state[HEAD]:
        full = state[HEAD] - state[TAIL] >= QUEUE - 1
        old = queue[int(state[TAIL]) % QUEUE]
        if not full and state[WAY] - old[3] < LAG:
            return
        layers = swept_layers(old[2], grid[LAYER], distance.shape[2])
        after = queue[int(state[TAIL] + 1) % QUEUE]
        if layers > 0:
            deeper = int(state[LAYERS])
            if layers > deeper:
                sweep(distance, grid, old[0], old[1], given[RADIUS], deeper, layers, True)
            sweep(distance, grid, old[0], old[1], given[RADIUS], 0, min(layers, deeper), False)
        is_far = after[3] - old[3] > 1e-4  # a rim of the next place would not reach this one
        state[LAYERS] = 0.0 if is_far else layers
        state[TAIL] += 1.0


@njit(cache=True, nogil=True)
def engage(at, around, distance, grid, given, found, width):  # type: ignore[no-untyped-def]
    """Fill `width` (BINS, 1 + layers), m of edge that touches material at each angle: in all, then in each layer.

    `around` (BINS, 2) has the directions.  Return how many layers can be cut.
    """
    layer, radius = grid[LAYER], given[RADIUS]
    last = min(max(math.ceil(-at[2] / layer), 0), distance.shape[2])
    for j in range(BINS):
        width[j, 0] = 0.0
        if last > 0:
            look(distance, grid, at[0] + radius * around[j, 0], at[1] + radius * around[j, 1], 0, last, found)
        for k in range(last):
            touching = layer * min(max(found[k] / TOUCH, 0.0), 1.0)
            if k == last - 1:
                touching *= min(-at[2] / layer - k, 1.0)
            width[j, 1 + k] = touching
            width[j, 0] += touching
    return last


@njit(cache=True, nogil=True)
def touching_share(at, around, distance, grid, given, found):  # type: ignore[no-untyped-def]
    """Return what of the area below the tool is material, 0 to 1."""
    below = max(math.floor(0.5 - at[2] / grid[LAYER]), 0)
    if at[2] > 0.0 or below >= distance.shape[2]:
        return 0.0
    touching = 0
    for ring in range(4):
        reach = given[RADIUS] * (ring + 0.5) / 4
        for j in range(0, BINS, 10):
            look(distance, grid, at[0] + reach * around[j, 0], at[1] + reach * around[j, 1], below, below + 1, found)
            touching += found[below] > 0.0
    return touching / (4 * (BINS // 10))


class Cut(NamedTuple):
    """All arrays of a cut.

    `origin` (3,) is the middle of the block's top, m; `distance` and `grid` as in `workpiece_kernel`; `hardness` (2, 3)
    as `CuttingForce.table`; `wobble` (teeth,), m; `around` (BINS, 2) has directions; `given` and `turned` as in
    `end_mill_kernel`; `state` and `queue` (QUEUE, 4) as above; `motion` (4, 3) has where the tool was (m), the force on
    it (N), its speed (m/s) and the force before (N), `ring` (SPAN, 3) the last moments on it (N m); `width` (BINS, 1 +
    layers) and `found` (layers,) are room.
    """

    origin: np.ndarray
    distance: np.ndarray
    grid: np.ndarray
    hardness: np.ndarray
    wobble: np.ndarray
    around: np.ndarray
    given: np.ndarray
    state: np.ndarray
    turned: np.ndarray
    queue: np.ndarray
    motion: np.ndarray
    ring: np.ndarray
    width: np.ndarray
    found: np.ndarray


@njit(cache=True, nogil=True)
def _push(at, free, give, cut, meeting, wrench):  # type: ignore[no-untyped-def]
    """Fill `meeting` with speed and mean force, N, and `wrench` (6,) with force and moment of this sample's teeth."""
    given, (speed, _, slope, room) = cut.given, meeting
    last = engage(at, cut.around, cut.distance, cut.grid, given, cut.found, cut.width)
    share = 0.0
    meet(free, cut.motion[1], give, share, cut.around, cut.width, cut.hardness, given, meeting)
    if is_sinking(speed, given):
        share = touching_share(at, cut.around, cut.distance, cut.grid, given, cut.found)
        meet(free, cut.motion[1], give, share, cut.around, cut.width, cut.hardness, given, meeting)
    turn(
        last, at, speed, cut.around, cut.width, cut.hardness, cut.wobble, cut.grid[LAYER], given, cut.turned, wrench
    )  # fmt: skip
    lift = room[0]
    lift[:] = 0.0
    wrench[5] += ends(speed, share, cut.hardness, given, lift, slope)
    wrench[2] += lift[2]


@njit(cache=True, nogil=True)
def run(tool, give, force, moment, teeth_force, cut):  # type: ignore[no-untyped-def]
    """Run one frame; signals as in `PocketMilling.run`."""
    at, free, wrench = np.empty(3), np.empty(3), np.empty(6)
    was, held, before = cut.motion[0], cut.motion[1], cut.motion[3]
    given, span = cut.given, int(cut.given[SPAN])
    meeting = cut.motion[2], np.empty(3), np.empty((3, 3)), np.empty((6, 3))
    push = meeting[1]
    for n in range(tool.shape[0]):
        done = int(cut.state[DONE])
        for r in range(3):
            at[r] = tool[n, r] - cut.origin[r]
        if done == 0:
            was[:] = at
            cut.queue[0, :3] = at
        for r in range(3):  # less what the tool gave way for the last change of force, which it has just done
            free[r] = at[r] - was[r]
            for k in range(3):
                free[r] -= give[n, 3 * r + k] * (held[k] - before[k])
            free[r] = free[r] / given[PERIOD] + given[PERIOD] / MASS * (held[r] - before[r])
        was[:] = at
        take(at, cut.distance, cut.grid, given, cut.state, cut.queue)
        _push(at, free, give[n], cut, meeting, wrench)
        cut.ring[done % span] = wrench[3:]
        for r in range(3):
            before[r], held[r] = held[r], push[r]
            force[n, r], teeth_force[n, r], moment[n, r] = push[r], wrench[r], 0.0
            for k in range(span):
                moment[n, r] += cut.ring[k, r] / span
        cut.state[DONE] += 1.0
