"""The compiled kernel of a cut tooth by tooth: what is taken, what pushes, and what a feed costs."""

import math
from typing import NamedTuple

import numpy as np

from firmware_sim.plants.end_mill_kernel import BINS
from firmware_sim.plants.milling_kernel import engage, take, touching_share
from firmware_sim.plants.tooth_kernel import PLACE, SPEED, lean, ring, sink, stiffness_of, turn
from rigkit.compiled import njit

KEPT = np.dtype([("angle", "f8"), ("part", "f8"), ("kappa", "f8"), ("beta", "f8")], align=True)
"""rad, parts so far, m/(N s), 1."""
SPOT = 1e-3
"""m between points of the map of hardness."""
PASSES = 12
"""Of teeth before whose waves are remembered: what is beyond their deepest is what can be cut."""
SLOWEST, LEAST = 1e-4, 0.05
"""m/s and N, of which kappa and beta are told."""


class Cut(NamedTuple):
    """All arrays of a cut.

    `origin` (3,), `distance`, `grid`, `state`, `queue`, `width`, `found`, `around` as in `milling_kernel.Cut`; `spots`
    (rows, columns), how hard the block is, 1; `wobble`, `given`, `mode`, `ringing`, `hanging` as in
    `tooth_kernel`.  `hard` (BINS,) is room.  `past` (parts, 3) has where the tool was, m, in a ring; `motion` (3, 3)
    where the robot held it (m), the force told last, and the force pulled now (N); `turns` (SPAN, 12) the last samples'
    force on the robot, moment, force of the teeth, and place; `kept` of one `KEPT`.
    """

    origin: np.ndarray
    distance: np.ndarray
    grid: np.ndarray
    spots: np.ndarray
    wobble: np.ndarray
    around: np.ndarray
    given: np.ndarray
    mode: np.ndarray
    state: np.ndarray
    queue: np.ndarray
    width: np.ndarray
    found: np.ndarray
    hard: np.ndarray
    past: np.ndarray
    ringing: np.ndarray
    hanging: np.ndarray
    motion: np.ndarray
    turns: np.ndarray
    kept: np.ndarray


@njit(cache=True, nogil=True)
def hardness_at(x: float, y: float, spots: np.ndarray) -> float:
    """Return how hard the block is at a place, m from its middle."""
    rows, columns = spots.shape
    u = min(max(x / SPOT + 0.5 * (columns - 1), 0.0), columns - 1.001)
    v = min(max(y / SPOT + 0.5 * (rows - 1), 0.0), rows - 1.001)
    i, j = int(v), int(u)
    u, v = u - j, v - i
    low = (1.0 - u) * spots[i, j] + u * spots[i, j + 1]
    return float((1.0 - v) * low + v * ((1.0 - u) * spots[i + 1, j] + u * spots[i + 1, j + 1]))


@njit(cache=True, nogil=True)
def _harden(at: np.ndarray, along: np.ndarray, cut: Cut) -> None:
    """Fill `cut.hard` where there is material: its map, and more across the fibres along x."""
    given = cut.given[0]
    radius, across = given.radius, 1.0 + given.across * along[1] * along[1]
    for j in range(BINS):
        if cut.width[j, 0] != 0.0:
            x, y = at[0] + radius * cut.around[j, 0], at[1] + radius * cut.around[j, 1]
            cut.hard[j] = across * hardness_at(x, y, cut.spots)


@njit(cache=True, nogil=True)
def _recall(cut: Cut, before: np.ndarray) -> None:
    """Fill `before` (PASSES, 3) with where the tool was as each tooth before stood where this one does."""
    length, part, tooth = cut.past.shape[0], cut.kept[0].part, cut.given[0].tooth
    for back in range(before.shape[0]):
        when = part - (back + 1) * tooth
        whole = math.floor(when)
        share = when - whole
        low, high = int(max(whole, 0.0)) % length, int(max(whole + 1.0, 0.0)) % length
        for r in range(3):
            before[back, r] = (1.0 - share) * cut.past[low, r] + share * cut.past[high, r]


@njit(cache=True, nogil=True)
def _sample(
    last: int,
    share: float,
    free: np.ndarray,
    cut: Cut,
    stiff: np.ndarray,
    is_held: bool,
    room: tuple[np.ndarray, ...],
    means: np.ndarray,
) -> None:
    """Go on by a sample part by part; fill `means` (9,) with force on the robot, moment, and force of the teeth."""
    here, before, push = room
    given, kept, pulled = cut.given[0], cut.kept[0], cut.motion[2]
    parts, edges = given.parts, (cut.around, cut.width, cut.hard)
    means[:] = 0.0
    for part in range(parts):
        for r in range(3):  # halfway through the part over which the force is held
            here[r] = cut.motion[0, r] + (free[r] - cut.motion[0, r]) * (part + 0.5) / parts
            here[r] += cut.hanging[PLACE, r] + 0.5 * given.period * cut.hanging[SPEED, r]
        for r in range(2):
            here[r] += cut.ringing[PLACE, r] + 0.5 * given.period * cut.ringing[SPEED, r]
        kept.part += 1.0
        cut.past[int(kept.part) % cut.past.shape[0]] = here
        _recall(cut, before)
        turn(kept.angle, last, here, before, edges, cut.wobble, given, push)
        if share > 0.0:
            sink(share, hardness_at(here[0], here[1], cut.spots), here, before, given, push)
        ring(push, cut.mode, cut.ringing)
        if is_held:
            lean(push, stiff, given, cut.hanging, pulled)
        else:
            pulled[:] = push[:3]
        for r in range(3):
            means[r] += pulled[r] / parts
            means[3 + r] += push[3 + r] / parts
            means[6 + r] += push[r] / parts
        kept.angle = (kept.angle + given.turn) % (2.0 * math.pi)


@njit(cache=True, nogil=True)
def _tell(at: np.ndarray, done: int, cut: Cut, means: np.ndarray, turned: np.ndarray) -> None:
    """Note a sample; fill `means` with the mean over a turn where that is told, and renew kappa and beta.

    `turned` (9,) is room.
    """
    given, kept, span = cut.given[0], cut.kept[0], cut.turns.shape[0]
    row = cut.turns[done % span]
    along, across = at[0] - row[9], at[1] - row[10]  # since a turn ago
    row[:9], row[9:] = means, at
    turned[:], length = 0.0, min(done + 1.0, given.span)
    for back in range(min(done + 1, span)):
        weight = min(1.0, length - back) / length
        for r in range(9):
            turned[r] += weight * cut.turns[(done - back) % span, r]
    if given.averaged:
        means[:] = turned
    way = math.hypot(along, across)
    speed = way / (span * given.parts * given.period)
    if done >= span and speed > SLOWEST:
        along, across = along / way, across / way
        against = -(turned[6] * along + turned[7] * across)
        if against > LEAST:
            kept.kappa = speed / against
            kept.beta = (-turned[6] * across + turned[7] * along) / against


@njit(cache=True, nogil=True)
def run(tool: np.ndarray, give: np.ndarray, told: tuple[np.ndarray, ...], cut: Cut) -> None:
    """Run one frame; signals as in `ToothCutPlant.run`: `told` is what it fills."""
    force, moment, teeth_force, kappa, beta = told
    at, free, stiff, along = np.empty(3), np.empty(3), np.zeros((3, 3)), np.zeros(2)
    means, turned = np.empty(9), np.empty(9)
    room = np.empty(3), np.empty((PASSES, 3)), np.empty(6)
    held, pulled = cut.motion[0], cut.motion[1]
    given, grid, state, kept = cut.given[0], cut.grid[0], cut.state[0], cut.kept[0]
    for n in range(tool.shape[0]):
        done = state.done
        is_held = stiffness_of(give[n], stiff)
        for r in range(3):  # less what the robot gives way by now
            free[r] = tool[n, r] - cut.origin[r]
            if is_held:
                for k in range(3):
                    free[r] -= give[n, 3 * r + k] * pulled[k]
        if done == 0:
            held[:] = free
            cut.queue[0, :3] = free
            cut.past[:] = free
            cut.turns[:, 9:] = free
        for r in range(3):
            at[r] = free[r] + cut.hanging[PLACE, r]
        way = math.hypot(free[0] - held[0], free[1] - held[1])
        if way > 0.0:
            along[0], along[1] = (free[0] - held[0]) / way, (free[1] - held[1]) / way
        take(at, cut.distance, grid, given, state, cut.queue)
        last = engage(at, cut.around, cut.distance, grid, given, cut.found, cut.width)
        _harden(at, along, cut)
        share = 0.0
        if held[2] - free[2] > given.dish * way:
            share = touching_share(at, cut.around, cut.distance, grid, given, cut.found)
        _sample(last, share, free, cut, stiff, is_held, room, means)
        held[:] = free
        _tell(at, done, cut, means, turned)
        for r in range(3):
            pulled[r] = force[n, r] = means[r]
            moment[n, r], teeth_force[n, r] = means[3 + r], means[6 + r]
        kappa[n, 0], beta[n, 0] = kept.kappa, kept.beta
        state.done = done + 1
