"""The compiled kernel of an end mill in a block: it takes material, touches what is left, and is pushed by that."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from firmware_sim.plants.end_mill_kernel import BINS, PERIOD, RADIUS, SPAN, descent, meet, plunge, turn
from firmware_sim.plants.workpiece_kernel import LAYER, look, sweep, swept_layers

DONE, WAY, HEAD, TAIL, LAYERS, CELLS = range(6)
"""Of `state`: samples, m, the queue's ends, layers taken at the last sweep."""
STEP, LAG = 5e-6, 1e-4
"""m: a place of the tool is taken out of the block when the tool has come `LAG` further; places are `STEP` apart."""
QUEUE = 64
TOUCH = 2e-6
"""m of material before an edge that counts as a full engagement."""


@njit(cache=True, nogil=True)
def _take(at, distance, grid, given, state, queue):  # type: ignore[no-untyped-def]
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
def _engage(at, around, distance, grid, given, found, width):  # type: ignore[no-untyped-def]
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
def _touching(at, around, distance, grid, given, found):  # type: ignore[no-untyped-def]
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
    `end_mill_kernel`; `state` and `queue` (QUEUE, 4) as above; `motion` (3, 3) has where the tool was (m), the force on
    it (N) and its speed along x and y (m/s), `ring` (SPAN, 3) the last moments on it (N m); `width` (BINS, 1 + layers)
    and `found` (layers,) are room.
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
def _push(at, given_speed, cut, push, wrench):  # type: ignore[no-untyped-def]
    """Fill `push` (7,) with the mean force, N, and `wrench` (6,) with force and moment of this sample's teeth."""
    held, speed, given = cut.motion[1], cut.motion[2], cut.given
    last = _engage(at, cut.around, cut.distance, cut.grid, given, cut.found, cut.width)
    meet(given_speed, held, cut.around, cut.width, cut.hardness, given, push, speed)
    flank = push[2]
    faster = descent(given_speed, held, given, push, speed)
    share = _touching(at, cut.around, cut.distance, cut.grid, given, cut.found) if faster > 0.0 else 0.0
    twist = plunge(faster, share, cut.hardness, given, push)
    turn(
        last, at, speed, cut.around, cut.width, cut.hardness, cut.wobble, cut.grid[LAYER], given, cut.turned, wrench
    )  # fmt: skip
    wrench[2] += push[2] - flank
    wrench[5] += twist


@njit(cache=True, nogil=True)
def run(tool: np.ndarray, force: np.ndarray, moment: np.ndarray, teeth_force: np.ndarray, cut: Cut) -> None:
    """Run one frame; signals as in `PocketMilling.run`."""
    at, given_speed, wrench, push = np.empty(3), np.empty(3), np.empty(6), np.empty(7)
    was, held, given, span = cut.motion[0], cut.motion[1], cut.given, int(cut.given[SPAN])
    for n in range(tool.shape[0]):
        done = int(cut.state[DONE])
        for r in range(3):
            at[r] = tool[n, r] - cut.origin[r]
        if done == 0:
            was[:] = at
            cut.queue[0, :3] = at
        for r in range(3):
            given_speed[r] = (at[r] - was[r]) / given[PERIOD]
        was[:] = at
        _take(at, cut.distance, cut.grid, given, cut.state, cut.queue)
        _push(at, given_speed, cut, push, wrench)
        cut.ring[done % span] = wrench[3:]
        for r in range(3):
            held[r] = push[r]
            force[n, r], teeth_force[n, r], moment[n, r] = push[r], wrench[r], 0.0
            for k in range(span):
                moment[n, r] += cut.ring[k, r] / span
        cut.state[DONE] += 1.0
