"""The compiled kernel of an end mill's forces: their mean over a turn, found with the tool's speed; tooth by tooth."""

import math

import numpy as np

from firmware_sim.plants.record import Record
from rigkit.compiled import njit

MILL = np.dtype(
    [
        ("radius", "f8"),  # m
        ("teeth", "i8"),
        ("turn", "f8"),  # rad a sample
        ("helix", "f8"),  # tangent
        ("substeps", "i8"),  # a sample
        ("tooth", "f8"),  # s a tooth
        ("dish", "f8"),  # tangent
        ("span", "i8"),  # samples a turn
        ("period", "f8"),  # s a sample
        ("layer", "f8"),  # m of the block's layers
    ],
    align=True,
)
"""A tool and its spindle: `given`."""
TURNED = np.dtype([("angle", "f8"), ("chips", "f8")], align=True)
"""rad, m^3 of chips."""
TANGENTIAL, RADIAL, AXIAL = range(3)
BINS = 120
"""Angles around the tool at which its engagement is looked up."""
EDGE = 1e-6
"""m of chip thickness at which the edge forces are whole; assumed: published ones are for thicker chips."""
ROUNDS = 12
CLOSE = 1e-7
"""m/s, of a speed that is found."""
MASS = 4.0
"""kg, of what the speed of a tool is found with beside what gives way at once; a robot with a spindle has 7 and more.
Chosen: from a third of the true mass down nothing shakes, and force lags it by 2 `PERIOD`^2 / `MASS` times damping."""


@njit(cache=True, nogil=True)
def flank(
    speed: np.ndarray,
    around: np.ndarray,
    width: np.ndarray,
    hardness: np.ndarray,
    given: Record,
    push: np.ndarray,
    slope: np.ndarray,
) -> None:
    """Fill `push` (3,), the flank's mean force over a turn, N, at `speed` (3,), m/s, and its `slope` (3, 3), N s/m."""
    push[:], slope[:] = 0.0, 0.0
    share = given.teeth / BINS
    for j in range(BINS):
        x, y = around[j, 0], around[j, 1]
        h = given.tooth * (speed[0] * x + speed[1] * y)
        if h <= 0.0 or width[j, 0] == 0.0:
            continue
        rub, growth = min(h / EDGE, 1.0), (1.0 / EDGE if h < EDGE else 0.0)
        wide = share * width[j, 0]
        tangential = wide * (hardness[0, TANGENTIAL] * h + hardness[1, TANGENTIAL] * rub)
        radial = wide * (hardness[0, RADIAL] * h + hardness[1, RADIAL] * rub)
        push[0] += -tangential * y - radial * x
        push[1] += tangential * x - radial * y
        push[2] -= wide * (hardness[0, AXIAL] * h + hardness[1, AXIAL] * rub)
        tangential = wide * given.tooth * (hardness[0, TANGENTIAL] + hardness[1, TANGENTIAL] * growth)
        radial = wide * given.tooth * (hardness[0, RADIAL] + hardness[1, RADIAL] * growth)
        along, across = -tangential * y - radial * x, tangential * x - radial * y
        up = -wide * given.tooth * (hardness[0, AXIAL] + hardness[1, AXIAL] * growth)
        slope[0, 0] += along * x
        slope[0, 1] += along * y
        slope[1, 0] += across * x
        slope[1, 1] += across * y
        slope[2, 0] += up * x
        slope[2, 1] += up * y


@njit(cache=True, nogil=True)
def is_sinking(speed: np.ndarray, given: Record) -> bool:
    """Whether the tool comes down more steeply than its edges below are hollow."""
    return bool(-speed[2] > given.dish * math.sqrt(speed[0] * speed[0] + speed[1] * speed[1]))


@njit(cache=True, nogil=True)
def ends(
    speed: np.ndarray, share: float, hardness: np.ndarray, given: Record, push: np.ndarray, slope: np.ndarray
) -> float:
    """Add to `push` and its `slope` what the edges below the tool feel; return the moment about its axis, N m.

    `share` of them touches material.  They cut where the tool comes down more steeply than they are hollow.
    """
    along = math.sqrt(speed[0] * speed[0] + speed[1] * speed[1])
    h = given.tooth * (-speed[2] - given.dish * along)
    if h <= 0.0 or share == 0.0:
        return 0.0
    length, rub = given.teeth * given.radius * share, min(h / EDGE, 1.0)
    push[2] += length * (hardness[0, RADIAL] * h + hardness[1, RADIAL] * rub)
    growth = length * given.tooth * (hardness[0, RADIAL] + (hardness[1, RADIAL] / EDGE if h < EDGE else 0.0))
    slope[2, 2] -= growth
    if along > 0.0:
        for r in range(2):
            slope[2, r] -= growth * given.dish * speed[r] / along
    return float(0.5 * given.radius * length * (hardness[0, TANGENTIAL] * h + hardness[1, TANGENTIAL] * rub))


@njit(cache=True, nogil=True)
def meet(
    free: np.ndarray,
    held: np.ndarray,
    give: np.ndarray,
    share: float,
    edges: tuple[np.ndarray, ...],
    given: Record,
    meeting: tuple[np.ndarray, ...],
) -> None:
    """Find the speed (m/s) and the force that belong together where the tool gives way at once.

    v = v_free + (give / T + T / `MASS`) (F(v) - F_held), T = `PERIOD`; `free` (3,), m/s, is the tool's speed if the
    force stays as `held` (3,), N, and `give` (9,), m/N, row by row, what a force moves it at once.  By Newton's method,
    with steps halved until they help; `meeting` has the speed (3,), where it begins and ends, its force (3,), and room,
    (3, 3) and (6, 3); `edges` is around, width and hardness.
    """
    around, width, hardness = edges
    speed, push, slope, room = meeting
    off, step, near, newton = room[0], room[1], room[2], room[3:]
    flank(speed, around, width, hardness, given, push, slope)
    ends(speed, share, hardness, given, push, slope)
    size = _apart(speed, free, held, give, push, given, off)
    for _ in range(ROUNDS):
        if size < CLOSE:
            break
        for r in range(3):
            for c in range(3):
                newton[r, c] = 1.0 if r == c else 0.0
                for k in range(3):
                    newton[r, c] -= give[3 * r + k] / given.period * slope[k, c]
                newton[r, c] -= given.period / MASS * slope[r, c]
        _solve(newton, off, step)
        part, before = 1.0, size
        for _ in range(ROUNDS):
            for r in range(3):
                near[r] = speed[r] - part * step[r]
            flank(near, around, width, hardness, given, push, slope)
            ends(near, share, hardness, given, push, slope)
            size = _apart(near, free, held, give, push, given, off)
            if size < before:
                break
            part *= 0.5
        speed[:] = near


@njit(cache=True, nogil=True)
def _apart(
    speed: np.ndarray,
    free: np.ndarray,
    held: np.ndarray,
    give: np.ndarray,
    push: np.ndarray,
    given: Record,
    off: np.ndarray,
) -> float:
    """Fill by how much a speed and its force do not belong together, m/s; return the length of that."""
    for r in range(3):
        off[r] = speed[r] - free[r] - given.period / MASS * (push[r] - held[r])
        for k in range(3):
            off[r] -= give[3 * r + k] / given.period * (push[k] - held[k])
    return math.sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2])


@njit(cache=True, nogil=True)
def _solve(matrix: np.ndarray, right: np.ndarray, found: np.ndarray) -> None:
    """Solve three equations by Cramer's rule."""
    whole = 0.0
    found[:] = 0.0
    for r in range(3):
        a, b = (r + 1) % 3, (r + 2) % 3
        for c in range(3):
            d, e = (c + 1) % 3, (c + 2) % 3
            minor = matrix[a, d] * matrix[b, e] - matrix[a, e] * matrix[b, d]
            found[c] += minor * right[r]
            if r == 0:
                whole += minor * matrix[0, c]
    for c in range(3):
        found[c] /= whole


@njit(cache=True, nogil=True)
def _chip(thickness: float, tooth: int, wobble: np.ndarray) -> float:
    """Return a tooth's chip, m, where a true tool's is `thickness`: down to the deepest cut of the teeth before it.

    `wobble` (teeth,) is by how much each tooth stands out, m.
    """
    teeth = wobble.shape[0]
    least: float = thickness * teeth
    for back in range(1, teeth):
        least = min(least, back * thickness + wobble[tooth] - wobble[(tooth - back) % teeth])
    return max(least, 0.0)


@njit(cache=True, nogil=True)
def _pressed(h: float, wide: float, hardness: np.ndarray) -> tuple[float, float, float]:
    """Return what a chip of `h` (m) on `wide` (m) of an edge pushes with, N: tangential, radial and axial."""
    rub = min(h / EDGE, 1.0)
    tangential = wide * (hardness[0, TANGENTIAL] * h + hardness[1, TANGENTIAL] * rub)
    radial = wide * (hardness[0, RADIAL] * h + hardness[1, RADIAL] * rub)
    axial = wide * (hardness[0, AXIAL] * h + hardness[1, AXIAL] * rub)
    return tangential, radial, axial


@njit(cache=True, nogil=True)
def turn(
    last: int,
    at: np.ndarray,
    speed: np.ndarray,
    edges: tuple[np.ndarray, ...],
    wobble: np.ndarray,
    given: Record,
    turned: Record,
    wrench: np.ndarray,
) -> None:
    """Turn the tool for a sample, and fill `wrench` (6,): mean force (N) and moment about the tip (N m) on it.

    It turns clockwise seen from above; a higher part of a tooth comes later.
    """
    (around, width, hardness), radius, teeth, substeps = edges, given.radius, given.teeth, given.substeps
    wrench[:] = 0.0
    step = given.turn / substeps
    for _ in range(substeps):
        for tooth in range(teeth):
            tip = 2.0 * math.pi * tooth / teeth - turned.angle
            for k in range(last):
                high = max(-(k + 0.5) * given.layer - at[2], 0.0)
                angle = (tip + high * given.helix / radius) / (2.0 * math.pi)
                j = int((angle - math.floor(angle)) * BINS) % BINS
                if width[j, 1 + k] == 0.0:
                    continue
                x, y = around[j, 0], around[j, 1]
                thickness = given.tooth * (speed[0] * x + speed[1] * y)
                if thickness <= 0.0:
                    continue
                h = _chip(thickness, tooth, wobble)
                turned.chips += h * width[j, 1 + k] * radius * step
                tangential, radial, axial = _pressed(h, width[j, 1 + k], hardness)
                push_x, push_y = -tangential * y - radial * x, tangential * x - radial * y
                wrench[0] += push_x
                wrench[1] += push_y
                wrench[2] -= axial
                wrench[3] += -radius * y * axial - high * push_y
                wrench[4] += high * push_x + radius * x * axial
                wrench[5] += radius * tangential
        turned.angle = (turned.angle + step) % (2.0 * math.pi)
    for r in range(6):
        wrench[r] /= substeps
