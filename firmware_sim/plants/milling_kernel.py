"""The compiled kernel of an end mill in a block: it takes material, touches what is left, and is pushed by that."""

import math
from typing import NamedTuple

import numpy as np

from firmware_sim.plants.end_mill_kernel import BINS, MASS, ends, is_sinking, meet, turn
from firmware_sim.plants.record import Record
from firmware_sim.plants.workpiece_kernel import look, sweep, swept_layers
from rigkit.compiled import njit

STATE = np.dtype(
    [
        ("done", "i8"),  # samples
        ("way", "f8"),  # m
        # the queue's ends
        ("head", "i8"),
        ("tail", "i8"),
        ("layers", "i8"),  # taken at the last sweep
    ],
    align=True,
)
STEP, LAG = 5e-6, 1e-4
"""m: a place of the tool is taken out of the block when the tool has come `LAG` further; places are `STEP` apart."""
QUEUE = 64
TOUCH = 2e-6
"""m of material before an edge that counts as a full engagement."""


@njit(cache=True, nogil=True)
def take(at: np.ndarray, distance: np.ndarray, grid: Record, given: Record, state: Record, queue: np.ndarray) -> None:
    """Queue the tool's place `at` (3,), m, and take out of the block where it was `LAG` ago; `queue` (QUEUE, 4)."""
    newest = queue[state.head % QUEUE]
    moved = math.sqrt((at[0] - newest[0]) ** 2 + (at[1] - newest[1]) ** 2 + (at[2] - newest[2]) ** 2)
    if moved < STEP:
        return
    state.way += moved
    state.head += 1
    into = queue[state.head % QUEUE]
    into[:3] = at
    into[3] = state.way
    while state.tail < state.head:
        full = state.head - state.tail >= QUEUE - 1
        old = queue[state.tail % QUEUE]
        if not full and state.way - old[3] < LAG:
            return
        layers = swept_layers(old[2], grid.layer, distance.shape[2])
        after = queue[(state.tail + 1) % QUEUE]
        if layers > 0:
            deeper = state.layers
            if layers > deeper:
                sweep(distance, grid, old[0], old[1], given.radius, deeper, layers, True)
            sweep(distance, grid, old[0], old[1], given.radius, 0, min(layers, deeper), False)
        is_far = after[3] - old[3] > 1e-4  # a rim of the next place would not reach this one
        state.layers = 0 if is_far else layers
        state.tail += 1


@njit(cache=True, nogil=True)
def engage(
    at: np.ndarray,
    around: np.ndarray,
    distance: np.ndarray,
    grid: Record,
    given: Record,
    found: np.ndarray,
    width: np.ndarray,
) -> int:
    """Fill `width` (BINS, 1 + layers), m of edge that touches material at each angle: in all, then in each layer.

    `around` (BINS, 2) has the directions.  Return how many layers can be cut.
    """
    layer, radius = grid.layer, given.radius
    last: int = min(max(math.ceil(-at[2] / layer), 0), distance.shape[2])
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
def touching_share(
    at: np.ndarray, around: np.ndarray, distance: np.ndarray, grid: Record, given: Record, found: np.ndarray
) -> float:
    """Return what of the area below the tool is material, 0 to 1."""
    below = max(math.floor(0.5 - at[2] / grid.layer), 0)
    if at[2] > 0.0 or below >= distance.shape[2]:
        return 0.0
    touching = 0
    for ring in range(4):
        reach = given.radius * (ring + 0.5) / 4
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
def _push(
    at: np.ndarray, free: np.ndarray, give: np.ndarray, cut: Cut, meeting: tuple[np.ndarray, ...], wrench: np.ndarray
) -> None:
    """Fill `meeting` with speed and mean force, N, and `wrench` (6,) with force and moment of this sample's teeth."""
    given, (speed, _, slope, room) = cut.given[0], meeting
    edges, grid = (cut.around, cut.width, cut.hardness), cut.grid[0]
    last = engage(at, cut.around, cut.distance, grid, given, cut.found, cut.width)
    share = 0.0
    meet(free, cut.motion[1], give, share, edges, given, meeting)
    if is_sinking(speed, given):
        share = touching_share(at, cut.around, cut.distance, grid, given, cut.found)
        meet(free, cut.motion[1], give, share, edges, given, meeting)
    turn(last, at, speed, edges, cut.wobble, given, cut.turned[0], wrench)
    lift = room[0]
    lift[:] = 0.0
    wrench[5] += ends(speed, share, cut.hardness, given, lift, slope)
    wrench[2] += lift[2]


@njit(cache=True, nogil=True)
def run(
    tool: np.ndarray, give: np.ndarray, force: np.ndarray, moment: np.ndarray, teeth_force: np.ndarray, cut: Cut
) -> None:
    """Run one frame; signals as in `PocketMilling.run`."""
    at, free, wrench = np.empty(3), np.empty(3), np.empty(6)
    was, held, before = cut.motion[0], cut.motion[1], cut.motion[3]
    given, grid, state = cut.given[0], cut.grid[0], cut.state[0]
    span = given.span
    meeting = cut.motion[2], np.empty(3), np.empty((3, 3)), np.empty((6, 3))
    push = meeting[1]
    for n in range(tool.shape[0]):
        done = state.done
        for r in range(3):
            at[r] = tool[n, r] - cut.origin[r]
        if done == 0:
            was[:] = at
            cut.queue[0, :3] = at
        for r in range(3):  # less what the tool gave way for the last change of force, which it has just done
            free[r] = at[r] - was[r]
            for k in range(3):
                free[r] -= give[n, 3 * r + k] * (held[k] - before[k])
            free[r] = free[r] / given.period + given.period / MASS * (held[r] - before[r])
        was[:] = at
        take(at, cut.distance, grid, given, state, cut.queue)
        _push(at, free, give[n], cut, meeting, wrench)
        cut.ring[done % span] = wrench[3:]
        for r in range(3):
            before[r], held[r] = held[r], push[r]
            force[n, r], teeth_force[n, r], moment[n, r] = push[r], wrench[r], 0.0
            for k in range(span):
                moment[n, r] += cut.ring[k, r] / span
        state.done = done + 1
