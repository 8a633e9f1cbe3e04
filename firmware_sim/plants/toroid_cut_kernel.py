"""The compiled kernel of the toroid's cut: where the tool is in the workpiece, and the forces that follow from it."""

import math

import numpy as np
from numba import njit

from firmware_sim.plants.flush_kernel import flushed

RADIUS, DEPTH, TOOL, FEED, FORCE, SPAN, START, SMOOTH, EDGE, RATE, SETTINGS = range(11)
"""Of `settings`: m, m, m, m/s, N, samples, samples, 1 a sample, 1, samples/s."""
DONE, ANGLE, PROGRESS, SPEED, CELLS = range(5)
"""Of `state`: samples, rad, rad, m/s."""


@njit(cache=True, nogil=True)
def rotation(q, into):  # type: ignore[no-untyped-def]
    """Fill `into` (3, 3) from a unit quaternion w x y z."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    into[0, 0], into[0, 1], into[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    into[1, 0], into[1, 1], into[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    into[2, 0], into[2, 1], into[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@njit(cache=True, nogil=True)
def _level(at, state, given):  # type: ignore[no-untyped-def]
    """Go on to where the tool is, `at` (3,), and return its share of the full force: engagement, feed, depth."""
    angle = math.atan2(at[2], at[1])
    step = angle - state[ANGLE]
    step -= 2.0 * math.pi * math.floor(step / (2.0 * math.pi) + 0.5)
    state[ANGLE], state[PROGRESS] = angle, state[PROGRESS] + step
    speed = state[SPEED]
    state[SPEED] = flushed(speed + given[SMOOTH] * (step * given[RADIUS] * given[RATE] - speed))
    way = state[PROGRESS] * given[RADIUS]
    left = 2.0 * math.pi * given[RADIUS] - way
    edge = min(max(min(way, left) / given[TOOL], 0.0), 1.0)
    feed = min(max(state[SPEED] / given[FEED], 0.0), 3.0)
    depth = min(max(1.0 + at[0] / given[DEPTH], 0.0), 3.0)
    rubbing = given[EDGE] * min(10.0 * feed, 1.0)
    return 0.5 * (1.0 - math.cos(math.pi * edge)) * depth * (rubbing + (1.0 - given[EDGE]) * feed)


@njit(cache=True, nogil=True)
def _remember(slot, filled, workpiece, orientation, ring, mean):  # type: ignore[no-untyped-def]
    """Take a pose in, and fill `mean` (19,) with the mean of the last poses, forces and moments, and of such means."""
    ring[slot, :3], ring[slot, 3:7] = workpiece, orientation
    for c in range(19):
        mean[c] = 0.0
        for k in range(filled):
            mean[c] += ring[k, c]
        mean[c] /= filled
    for r in range(3):
        ring[slot, 13 + r], ring[slot, 16 + r] = mean[7 + r], mean[10 + r]


@njit(cache=True, nogil=True)
def _locate(tool, mean, zero, turned, away, at):  # type: ignore[no-untyped-def]
    """Fill `away` (3,) and `at` (3,): from the robot's tool point to the tool, in the base's and the workpiece's axes.

    `turned` (3, 3, 3): the workpiece's rotation when it was touched off and now, and from the base's axes into its own.
    """
    for r in range(3):
        away[r] = tool[r] + zero[r] - mean[r]
        for c in range(3):
            turned[2, r, c] = 0.0
            for k in range(3):
                turned[2, r, c] += turned[0, r, k] * turned[1, c, k]
    for r in range(3):
        at[r] = turned[2, r, 0] * away[0] + turned[2, r, 1] * away[1] + turned[2, r, 2] * away[2]


@njit(cache=True, nogil=True)
def _push(size, angle, ripple, shares, turned, push, onto):  # type: ignore[no-untyped-def]
    """Fill `onto` (3,) with the force on the tool, N, in the base's axes; `push` (3,) is room."""
    cosine, sine = math.cos(angle), math.sin(angle)
    normal, along = size * shares[0] * ripple[0], size * shares[1] * ripple[1]
    push[0] = -size * shares[2] * ripple[2]
    push[1], push[2] = normal * cosine + along * sine, normal * sine - along * cosine
    for r in range(3):
        onto[r] = turned[2, 0, r] * push[0] + turned[2, 1, r] * push[1] + turned[2, 2, r] * push[2]


@njit(cache=True, nogil=True)
def run(  # type: ignore[no-untyped-def]
    tool,
    workpiece,
    orientation,
    force,
    moment,
    plate_force,
    cut,
    face,
    ripple,
    shares,
    given,
    state,
    zero,
    turned,
    ring,
):
    """Run one frame; signals as in `ToroidCut.run`.

    `ripple` (samples, 3) multiplies the forces along normal, feed and axis, whose `shares` (3,) are of the whole;
    `zero` (3,) is the offset touched off; `ring` (span, 19) has the last poses, forces, moments, and means of both.
    """
    span = int(given[SPAN])
    mean, away, at, push = np.empty(19), np.empty(3), np.empty(3), np.empty(3)
    for n in range(tool.shape[0]):
        done = int(state[DONE])
        slot, is_cut = done % span, done > given[START]
        _remember(slot, min(done + 1, span), workpiece[n], orientation[n], ring, mean)
        rotation(mean[3:7], turned[1])
        if not is_cut:  # touched off: the tool is at the top, on the surface
            for r in range(3):
                zero[r] = mean[r] - tool[n, r] + (given[RADIUS] if r == 2 else 0.0)
            turned[0] = turned[1]
            state[ANGLE] = 0.5 * math.pi
        _locate(tool[n], mean, zero, turned, away, at)
        size = _level(at, state, given) * given[FORCE] if is_cut else 0.0
        _push(size, state[ANGLE], ripple[done % ripple.shape[0]], shares, turned, push, plate_force[n])
        for r in range(3):
            i, j = (r + 1) % 3, (r + 2) % 3
            ring[slot, 7 + r] = -plate_force[n, r]
            ring[slot, 10 + r] = away[j] * plate_force[n, i] - away[i] * plate_force[n, j]
            force[n, r], moment[n, r] = mean[13 + r], mean[16 + r]
            cut[n, r], face[n, r] = at[r], 0.0
        face[n, 0] = at[0] - tool[n, 0]
        state[DONE] += 1.0
