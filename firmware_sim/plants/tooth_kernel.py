"""The compiled kernel of teeth that cut: each one's chip from where the tool is and was, its force, and what rings."""

import math

from numba import njit

from firmware_sim.plants.end_mill_kernel import BINS, EDGE
from firmware_sim.plants.flush_kernel import flushed

(RADIUS, TEETH, TURN, HELIX, PARTS, TOOTH, DISH, SPAN, PERIOD, MASS, LOSS, AVERAGED, ACROSS, SETTINGS) = range(14)
"""Of `given`: m, 1, rad a part, tangent, parts a sample, parts a tooth, tangent, samples a turn, s a part, kg, s, 0 or
1, 1."""
SHARE, GROWTH, RUB, LAW = range(4)
"""Rows of `law` (LAW, 3), tangential, radial, axial: N/m^2 at a chip of `NOMINAL`, the power that falls, N/m."""
TANGENTIAL, RADIAL, AXIAL = range(3)
NOMINAL = 1e-3
"""m: Kienzle's chip [k_c1.1]."""
GULLET = 0.1
"""Of the tool's diameter: no tooth takes a thicker chip; assumed, flutes are about as deep."""
THIN = 1e-6
"""m: a chip below which the force falls straight to zero."""
PLACE, SPEED = range(2)
"""Of what rings: m and m/s."""


@njit(cache=True, nogil=True)
def edge_force(chip, law, direction):  # type: ignore[no-untyped-def]
    """Return the force on an edge, N a m of its width, by its chip (m): linear, or Kienzle's power, and its rubbing.

    k h (h / h_0)^-m + e; m = 0 is linear.  [Kienzle, VDI-Z 94 (1952) 299; Altintas, Manufacturing Automation, 2nd ed.,
    sec. 2.8, for the edge]
    """
    strength = law[SHARE, direction]
    if law[GROWTH, direction] != 0.0:
        strength *= (max(chip, THIN) / NOMINAL) ** -law[GROWTH, direction]
    return strength * chip + law[RUB, direction] * min(chip / EDGE, 1.0)


@njit(cache=True, nogil=True)
def chip_of(tooth, x, y, here, before, wobble):  # type: ignore[no-untyped-def]
    """Return a tooth's chip, m, in direction (x, y): down to the deepest that the teeth before it have cut, or nothing.

    `here` (3,) is where the tool is, `before` (passes, 3) where it was as each tooth before stood there, m; `wobble`
    (teeth,) is by how much each tooth stands out, m.  [Tlusty and Ismail, Ann. CIRP 30 (1981) 299]
    """
    teeth = wobble.shape[0]
    at = here[0] * x + here[1] * y + wobble[tooth]
    least = 1e9
    for back in range(1, before.shape[0] + 1):
        was = before[back - 1, 0] * x + before[back - 1, 1] * y + wobble[(tooth - back) % teeth]
        least = min(least, at - was)
    return max(least, 0.0)


@njit(cache=True, nogil=True)
def turn(angle, depth, last, layer, here, before, around, width, hard, law, wobble, given, push):  # type: ignore[no-untyped-def]
    """Fill `push` (6,), force (N) and moment about the tip (N m) on the tool, of all teeth at an angle of the spindle.

    The tool turns clockwise seen from above; a higher part of a tooth comes later.  `width` (BINS, 1 + layers), m, and
    `hard` (BINS,), 1, are what of the edge meets material there, and how hard that is.
    """
    push[:] = 0.0
    radius, teeth = given[RADIUS], int(given[TEETH])
    for tooth in range(teeth):
        tip = 2.0 * math.pi * tooth / teeth - angle
        for k in range(last):
            high = max(depth - (k + 0.5) * layer, 0.0)
            part = (tip + high * given[HELIX] / radius) / (2.0 * math.pi)
            j = int((part - math.floor(part)) * BINS) % BINS
            if width[j, 1 + k] == 0.0:
                continue
            x, y = around[j, 0], around[j, 1]
            chip = min(chip_of(tooth, x, y, here, before, wobble), 2.0 * GULLET * radius)
            if chip == 0.0:
                continue
            wide = hard[j] * width[j, 1 + k]
            tangential, radial = wide * edge_force(chip, law, TANGENTIAL), wide * edge_force(chip, law, RADIAL)
            axial = wide * edge_force(chip, law, AXIAL)
            push_x, push_y = -tangential * y - radial * x, tangential * x - radial * y
            push[0] += push_x
            push[1] += push_y
            push[2] -= axial
            push[3] += -radius * y * axial - high * push_y
            push[4] += high * push_x + radius * x * axial
            push[5] += radius * tangential


@njit(cache=True, nogil=True)
def sink(share, hardness, here, before, law, given, push):  # type: ignore[no-untyped-def]
    """Add to `push` what the edges below the tool feel where it comes down more steeply than they are hollow.

    `share` of them touches material.
    """
    old = before[0]
    along = math.hypot(here[0] - old[0], here[1] - old[1])
    chip = min(old[2] - here[2] - given[DISH] * along, 2.0 * GULLET * given[RADIUS])
    if chip <= 0.0 or share == 0.0:
        return
    length = hardness * given[TEETH] * given[RADIUS] * share
    push[2] += length * edge_force(chip, law, RADIAL)
    push[5] += 0.5 * given[RADIUS] * length * edge_force(chip, law, TANGENTIAL)


@njit(cache=True, nogil=True)
def ring(push, mode, ringing):  # type: ignore[no-untyped-def]
    """Move the tool's own mode on by a part under a force, N, held over it.

    `mode` (2, 6), x and y: q' = a q + b v + e F, v' = c q + d v + f F as a b c d e f; `ringing` (2, 2), m and m/s.
    """
    for r in range(2):
        place, speed = ringing[PLACE, r], ringing[SPEED, r]
        ringing[PLACE, r] = flushed(mode[r, 0] * place + mode[r, 1] * speed + mode[r, 4] * push[r])
        ringing[SPEED, r] = flushed(mode[r, 2] * place + mode[r, 3] * speed + mode[r, 5] * push[r])


@njit(cache=True, nogil=True)
def lean(push, stiff, given, hanging, pulled):  # type: ignore[no-untyped-def]
    """Move the spindle's mass on what gives way behind it by a part; fill `pulled` (3,), N, the force on the robot.

    `stiff` (3, 3), N/m; `hanging` (2, 3), m and m/s, beside where the robot holds it.
    """
    for r in range(3):
        pulled[r] = 0.0
        for c in range(3):
            pulled[r] += stiff[r, c] * (hanging[PLACE, c] + given[LOSS] * hanging[SPEED, c])
    for r in range(3):
        hanging[SPEED, r] = flushed(hanging[SPEED, r] + given[PERIOD] / given[MASS] * (push[r] - pulled[r]))
        hanging[PLACE, r] = flushed(hanging[PLACE, r] + given[PERIOD] * hanging[SPEED, r])


@njit(cache=True, nogil=True)
def stiffness_of(give, stiff):  # type: ignore[no-untyped-def]
    """Fill `stiff` (3, 3), N/m, from a compliance (9,), m/N, row by row; return whether there is any."""
    g = give
    if g[0] + g[4] + g[8] < 1e-12:
        return False
    whole = 0.0
    for r in range(3):
        a, b = (r + 1) % 3, (r + 2) % 3
        for c in range(3):
            d, e = (c + 1) % 3, (c + 2) % 3
            stiff[c, r] = g[3 * a + d] * g[3 * b + e] - g[3 * a + e] * g[3 * b + d]
            if r == 0:
                whole += stiff[c, 0] * g[c]
    for r in range(3):
        for c in range(3):
            stiff[r, c] /= whole
    return True
