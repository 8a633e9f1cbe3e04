"""The compiled kernel of an end mill's forces: their mean over a turn, found with the tool's speed; tooth by tooth."""

import math

from numba import njit

RADIUS, TEETH, TURN, HELIX, SUBSTEPS, TOOTH, DISH, SPAN, GIVE, PERIOD, SETTINGS = range(11)
"""Of `given`: m, 1, rad a sample, tangent, 1 a sample, s a tooth, tangent, samples, m/N, s a sample."""
ANGLE, CHIPS, TURNED = range(3)
"""Of `turned`: rad, m^3 of chips."""
TANGENTIAL, RADIAL, AXIAL = range(3)
BINS = 120
"""Angles around the tool at which its engagement is looked up."""
EDGE = 1e-6
"""m of chip thickness at which the edge forces are whole; assumed: published ones are for thicker chips."""
ROUNDS = 12
CLOSE = 1e-7
"""m/s, of a speed that is found."""


@njit(cache=True, nogil=True)
def mean_push(speed_x, speed_y, around, width, hardness, given, push):  # type: ignore[no-untyped-def]
    """Fill `push` (7,): the flank's mean force over a turn, N, at a speed, m/s, and how x and y change with it."""
    push[:] = 0.0
    share = given[TEETH] / BINS
    for j in range(BINS):
        x, y = around[j, 0], around[j, 1]
        h = given[TOOTH] * (speed_x * x + speed_y * y)
        if h <= 0.0 or width[j, 0] == 0.0:
            continue
        rub, growth = min(h / EDGE, 1.0), (1.0 / EDGE if h < EDGE else 0.0)
        wide = share * width[j, 0]
        tangential = wide * (hardness[0, TANGENTIAL] * h + hardness[1, TANGENTIAL] * rub)
        radial = wide * (hardness[0, RADIAL] * h + hardness[1, RADIAL] * rub)
        push[0] += -tangential * y - radial * x
        push[1] += tangential * x - radial * y
        push[2] -= wide * (hardness[0, AXIAL] * h + hardness[1, AXIAL] * rub)
        tangential = wide * given[TOOTH] * (hardness[0, TANGENTIAL] + hardness[1, TANGENTIAL] * growth)
        radial = wide * given[TOOTH] * (hardness[0, RADIAL] + hardness[1, RADIAL] * growth)
        along, across = -tangential * y - radial * x, tangential * x - radial * y
        push[3] += along * x
        push[4] += along * y
        push[5] += across * x
        push[6] += across * y


@njit(cache=True, nogil=True)
def meet(given_speed, held, around, width, hardness, given, push, speed):  # type: ignore[no-untyped-def]
    """Find the speed (m/s) and the force that belong together where the tool gives way at once, along x and y.

    v = v_given + g (F(v) - F_held), g = `GIVE` / `PERIOD`; `given_speed` (3,), m/s, came with the force `held` (3,), N.
    By Newton's method, with steps halved until they help; `speed` (3,) is where it begins and ends, and `push` (7,) its
    force.
    """
    give = given[GIVE] / given[PERIOD]
    x, y = speed[0], speed[1]
    mean_push(x, y, around, width, hardness, given, push)
    a = x - given_speed[0] - give * (push[0] - held[0])
    b = y - given_speed[1] - give * (push[1] - held[1])
    for _ in range(ROUNDS):
        size = math.sqrt(a * a + b * b)
        if size < CLOSE:
            break
        xx, xy, yx, yy = 1.0 - give * push[3], -give * push[4], -give * push[5], 1.0 - give * push[6]
        whole = xx * yy - xy * yx
        step_x, step_y = (yy * a - xy * b) / whole, (xx * b - yx * a) / whole
        part = 1.0
        for _ in range(ROUNDS):
            mean_push(x - part * step_x, y - part * step_y, around, width, hardness, given, push)
            a = x - part * step_x - given_speed[0] - give * (push[0] - held[0])
            b = y - part * step_y - given_speed[1] - give * (push[1] - held[1])
            if a * a + b * b < size * size:
                break
            part *= 0.5
        x, y = x - part * step_x, y - part * step_y
    speed[0], speed[1] = x, y


@njit(cache=True, nogil=True)
def _chip(thickness, tooth, wobble):  # type: ignore[no-untyped-def]
    """Return a tooth's chip, m, where a true tool's is `thickness`: down to the deepest cut of the teeth before it.

    `wobble` (teeth,) is by how much each tooth stands out, m.
    """
    teeth = wobble.shape[0]
    least = thickness * teeth
    for back in range(1, teeth):
        least = min(least, back * thickness + wobble[tooth] - wobble[(tooth - back) % teeth])
    return max(least, 0.0)


@njit(cache=True, nogil=True)
def turn(last, at, speed, around, width, hardness, wobble, layer, given, turned, wrench):  # type: ignore[no-untyped-def]
    """Turn the tool for a sample, and fill `wrench` (6,): mean force (N) and moment about the tip (N m) on it.

    It turns clockwise seen from above; a higher part of a tooth comes later.
    """
    radius, teeth, substeps = given[RADIUS], int(given[TEETH]), int(given[SUBSTEPS])
    wrench[:] = 0.0
    step = given[TURN] / substeps
    for _ in range(substeps):
        for tooth in range(teeth):
            tip = 2.0 * math.pi * tooth / teeth - turned[ANGLE]
            for k in range(last):
                high = max(-(k + 0.5) * layer - at[2], 0.0)
                angle = (tip + high * given[HELIX] / radius) / (2.0 * math.pi)
                j = int((angle - math.floor(angle)) * BINS) % BINS
                if width[j, 1 + k] == 0.0:
                    continue
                x, y = around[j, 0], around[j, 1]
                thickness = given[TOOTH] * (speed[0] * x + speed[1] * y)
                if thickness <= 0.0:
                    continue
                h = _chip(thickness, tooth, wobble)
                rub = min(h / EDGE, 1.0)
                turned[CHIPS] += h * width[j, 1 + k] * radius * step
                tangential = width[j, 1 + k] * (hardness[0, TANGENTIAL] * h + hardness[1, TANGENTIAL] * rub)
                radial = width[j, 1 + k] * (hardness[0, RADIAL] * h + hardness[1, RADIAL] * rub)
                axial = width[j, 1 + k] * (hardness[0, AXIAL] * h + hardness[1, AXIAL] * rub)
                push_x, push_y = -tangential * y - radial * x, tangential * x - radial * y
                wrench[0] += push_x
                wrench[1] += push_y
                wrench[2] -= axial
                wrench[3] += -radius * y * axial - high * push_y
                wrench[4] += high * push_x + radius * x * axial
                wrench[5] += radius * tangential
        turned[ANGLE] = (turned[ANGLE] + step) % (2.0 * math.pi)
    for r in range(6):
        wrench[r] /= substeps


@njit(cache=True, nogil=True)
def descent(given_speed, held, given, push, speed):  # type: ignore[no-untyped-def]
    """Return by how much the tool comes down faster than its edges below are hollow, m/s, as far as its flank goes."""
    hollow = given[DISH] * math.sqrt(speed[0] * speed[0] + speed[1] * speed[1])
    return -(given_speed[2] + given[GIVE] / given[PERIOD] * (push[2] - held[2])) - hollow


@njit(cache=True, nogil=True)
def plunge(sink, share, hardness, given, push):  # type: ignore[no-untyped-def]
    """Find speed and force that belong together along z: add to `push[2]` what the edges below the tool feel.

    `share` of them touches material.  Return the moment about the tool's axis, N m.
    """
    if sink <= 0.0 or share == 0.0:
        return 0.0
    give, tooth, length = given[GIVE] / given[PERIOD], given[TOOTH], given[TEETH] * given[RADIUS] * share
    cut, edge = give * length * hardness[0, RADIAL] * tooth, give * length * hardness[1, RADIAL]
    slow = sink / (1.0 + cut + edge * tooth / EDGE)
    rub = min(slow * tooth / EDGE, 1.0)
    chip = tooth * (slow if rub < 1.0 else (sink - edge) / (1.0 + cut))
    push[2] += length * (hardness[0, RADIAL] * chip + hardness[1, RADIAL] * rub)
    return 0.5 * given[RADIUS] * length * (hardness[0, TANGENTIAL] * chip + hardness[1, TANGENTIAL] * rub)
