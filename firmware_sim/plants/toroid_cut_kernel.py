"""The compiled kernel of the toroid's cut: where the tool is in the workpiece, and the forces that follow from it."""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

CUT = np.dtype(
    [
        ("radius", "f8"),  # m
        ("depth", "f8"),  # m
        ("tool", "f8"),  # m
        ("feed", "f8"),  # m/s
        ("force", "f8"),  # N
        ("start", "f8"),  # samples
        ("smooth", "f8"),  # 1 a sample
        ("edge", "f8"),  # 1
        ("rate", "f8"),  # samples/s
        ("shares", "f8", 3),  # of the force: along normal, feed and axis
        # state
        ("done", "i8"),  # samples
        ("angle", "f8"),  # rad
        ("progress", "f8"),  # rad
        ("speed", "f8"),  # m/s
        ("zero", "f8", 3),  # m, the offset touched off
        ("turned", "f8", (3, 3, 3)),  # the workpiece's rotation then and now, and from the base's axes into its own
    ],
    align=True,
)


@njit(cache=True, nogil=True)
def rotation(q: np.ndarray, into: np.ndarray) -> None:
    """Fill `into` (3, 3) from a unit quaternion w x y z."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    into[0, 0], into[0, 1], into[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    into[1, 0], into[1, 1], into[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    into[2, 0], into[2, 1], into[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@njit(cache=True, nogil=True)
def _level(at: np.ndarray, cut: Record) -> float:
    """Go on to where the tool is, `at` (3,), and return its share of the full force: engagement, feed, depth."""
    angle = math.atan2(at[2], at[1])
    step = angle - cut.angle
    step -= 2.0 * math.pi * math.floor(step / (2.0 * math.pi) + 0.5)
    cut.angle, cut.progress = angle, cut.progress + step
    speed = cut.speed
    cut.speed = flushed(speed + cut.smooth * (step * cut.radius * cut.rate - speed))
    way = cut.progress * cut.radius
    left = 2.0 * math.pi * cut.radius - way
    edge = min(max(min(way, left) / cut.tool, 0.0), 1.0)
    feed = min(max(cut.speed / cut.feed, 0.0), 3.0)
    depth = min(max(1.0 + at[0] / cut.depth, 0.0), 3.0)
    rubbing = cut.edge * min(10.0 * feed, 1.0)
    return float(0.5 * (1.0 - math.cos(math.pi * edge)) * depth * (rubbing + (1.0 - cut.edge) * feed))


@njit(cache=True, nogil=True)
def _remember(
    slot: int, filled: int, workpiece: np.ndarray, orientation: np.ndarray, ring: np.ndarray, mean: np.ndarray
) -> None:
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
def _locate(tool: np.ndarray, mean: np.ndarray, cut: Record, away: np.ndarray, at: np.ndarray) -> None:
    """Fill `away` and `at` (3,): from the robot's tool point to the tool, in the base's and the workpiece's axes."""
    zero, turned = cut.zero, cut.turned
    for r in range(3):
        away[r] = tool[r] + zero[r] - mean[r]
        for c in range(3):
            turned[2, r, c] = 0.0
            for k in range(3):
                turned[2, r, c] += turned[0, r, k] * turned[1, c, k]
    for r in range(3):
        at[r] = turned[2, r, 0] * away[0] + turned[2, r, 1] * away[1] + turned[2, r, 2] * away[2]


@njit(cache=True, nogil=True)
def _push(size: float, ripple: np.ndarray, cut: Record, push: np.ndarray, onto: np.ndarray) -> None:
    """Fill `onto` (3,) with the force on the tool, N, in the base's axes; `push` (3,) is room."""
    shares, turned = cut.shares, cut.turned
    cosine, sine = math.cos(cut.angle), math.sin(cut.angle)
    normal, along = size * shares[0] * ripple[0], size * shares[1] * ripple[1]
    push[0] = -size * shares[2] * ripple[2]
    push[1], push[2] = normal * cosine + along * sine, normal * sine - along * cosine
    for r in range(3):
        onto[r] = turned[2, 0, r] * push[0] + turned[2, 1, r] * push[1] + turned[2, 2, r] * push[2]


@njit(cache=True, nogil=True)
def run(
    seen: tuple[np.ndarray, ...],
    told: tuple[np.ndarray, ...],
    ripple: np.ndarray,
    ring: np.ndarray,
    cuts: np.ndarray,
) -> None:
    """Run one frame; signals as in `ToroidCut.run`.

    `ripple` (samples, 3) multiplies the forces along normal, feed and axis; `ring` (span, 19) has the last poses,
    forces, moments, and means of both; `cuts` is of one `CUT`.
    """
    (tool, workpiece, orientation), (force, moment, plate_force, place, face) = seen, told
    cut, span = cuts[0], len(ring)
    zero, turned = cut.zero, cut.turned
    mean, away, at, push = np.empty(19), np.empty(3), np.empty(3), np.empty(3)
    for n in range(tool.shape[0]):
        done = cut.done
        slot, is_cut = done % span, done > cut.start
        _remember(slot, min(done + 1, span), workpiece[n], orientation[n], ring, mean)
        rotation(mean[3:7], turned[1])
        if not is_cut:  # touched off: the tool is at the top, on the surface
            for r in range(3):
                zero[r] = mean[r] - tool[n, r] + (cut.radius if r == 2 else 0.0)
            turned[0, :, :] = turned[1]
            cut.angle = 0.5 * math.pi
        _locate(tool[n], mean, cut, away, at)
        size = _level(at, cut) * cut.force if is_cut else 0.0
        _push(size, ripple[done % ripple.shape[0]], cut, push, plate_force[n])
        for r in range(3):
            i, j = (r + 1) % 3, (r + 2) % 3
            ring[slot, 7 + r] = -plate_force[n, r]
            ring[slot, 10 + r] = away[j] * plate_force[n, i] - away[i] * plate_force[n, j]
            force[n, r], moment[n, r] = mean[13 + r], mean[16 + r]
            place[n, r], face[n, r] = at[r], 0.0
        face[n, 0] = at[0] - tool[n, 0]
        cut.done = done + 1
