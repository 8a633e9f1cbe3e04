"""The compiled kernel of teeth that cut: each one's chip from where the tool is and was, its force, and what rings."""

import math

import numpy as np

from firmware_sim.plants.end_mill_kernel import BINS, EDGE
from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

CUTTER = np.dtype(
    [
        ("radius", "f8"),  # m
        ("teeth", "i8"),
        ("turn", "f8"),  # rad a part
        ("helix", "f8"),  # tangent
        ("parts", "i8"),  # a sample
        ("tooth", "f8"),  # parts a tooth
        ("dish", "f8"),  # tangent
        ("span", "f8"),  # samples a turn
        ("period", "f8"),  # s a part
        ("mass", "f8"),  # kg
        ("loss", "f8"),  # s
        ("averaged", "?"),  # whether forces are told over a turn
        ("across", "f8"),  # 1
        ("layer", "f8"),  # m of the block's layers
        ("law", "f8", (3, 3)),  # rows as below
    ],
    align=True,
)
"""A tool, its spindle and its law: `given`."""
SHARE, GROWTH, RUB = range(3)
"""Rows of `law`, tangential, radial, axial: N/m^2 at a chip of `NOMINAL`, the power that falls, N/m."""
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
def edge_force(chip: float, law: np.ndarray, direction: int) -> float:
    """Return the force on an edge, N a m of its width, by its chip (m): linear, or Kienzle's power, and its rubbing.

    k h (h / h_0)^-m + e; m = 0 is linear.  [Kienzle, VDI-Z 94 (1952) 299; Altintas, Manufacturing Automation, 2nd ed.,
    sec. 2.8, for the edge]
    """
    strength = law[SHARE, direction]
    if law[GROWTH, direction] != 0.0:
        strength *= (max(chip, THIN) / NOMINAL) ** -law[GROWTH, direction]
    return float(strength * chip + law[RUB, direction] * min(chip / EDGE, 1.0))


@njit(cache=True, nogil=True)
def chip_of(tooth: int, x: float, y: float, here: np.ndarray, before: np.ndarray, wobble: np.ndarray) -> float:
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
def turn(
    angle: float,
    last: int,
    here: np.ndarray,
    before: np.ndarray,
    edges: tuple[np.ndarray, ...],
    wobble: np.ndarray,
    given: Record,
    push: np.ndarray,
) -> None:
    """Fill `push` (6,), force (N) and moment about the tip (N m) on the tool, of all teeth at an angle of the spindle.

    The tool turns clockwise seen from above; a higher part of a tooth comes later.  `edges` is around, width (BINS, 1 +
    layers), m, and hard (BINS,), 1: what of the edge meets material there, and how hard that is.
    """
    push[:] = 0.0
    (around, width, hard), law, depth = edges, given.law, -here[2]
    radius, teeth = given.radius, given.teeth
    for tooth in range(teeth):
        tip = 2.0 * math.pi * tooth / teeth - angle
        for k in range(last):
            high = max(depth - (k + 0.5) * given.layer, 0.0)
            part = (tip + high * given.helix / radius) / (2.0 * math.pi)
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
def sink(share: float, hardness: float, here: np.ndarray, before: np.ndarray, given: Record, push: np.ndarray) -> None:
    """Add to `push` what the edges below the tool feel where it comes down more steeply than they are hollow.

    `share` of them touches material.
    """
    old, law = before[0], given.law
    along = math.hypot(here[0] - old[0], here[1] - old[1])
    chip = min(old[2] - here[2] - given.dish * along, 2.0 * GULLET * given.radius)
    if chip <= 0.0 or share == 0.0:
        return
    length = hardness * given.teeth * given.radius * share
    push[2] += length * edge_force(chip, law, RADIAL)
    push[5] += 0.5 * given.radius * length * edge_force(chip, law, TANGENTIAL)


@njit(cache=True, nogil=True)
def ring(push: np.ndarray, mode: np.ndarray, ringing: np.ndarray) -> None:
    """Move the tool's own mode on by a part under a force, N, held over it.

    `mode` (2, 6), x and y: q' = a q + b v + e F, v' = c q + d v + f F as a b c d e f; `ringing` (2, 2), m and m/s.
    """
    for r in range(2):
        place, speed = ringing[PLACE, r], ringing[SPEED, r]
        ringing[PLACE, r] = flushed(mode[r, 0] * place + mode[r, 1] * speed + mode[r, 4] * push[r])
        ringing[SPEED, r] = flushed(mode[r, 2] * place + mode[r, 3] * speed + mode[r, 5] * push[r])


@njit(cache=True, nogil=True)
def lean(push: np.ndarray, stiff: np.ndarray, given: Record, hanging: np.ndarray, pulled: np.ndarray) -> None:
    """Move the spindle's mass on what gives way behind it by a part; fill `pulled` (3,), N, the force on the robot.

    `stiff` (3, 3), N/m; `hanging` (2, 3), m and m/s, beside where the robot holds it.
    """
    for r in range(3):
        pulled[r] = 0.0
        for c in range(3):
            pulled[r] += stiff[r, c] * (hanging[PLACE, c] + given.loss * hanging[SPEED, c])
    for r in range(3):
        hanging[SPEED, r] = flushed(hanging[SPEED, r] + given.period / given.mass * (push[r] - pulled[r]))
        hanging[PLACE, r] = flushed(hanging[PLACE, r] + given.period * hanging[SPEED, r])


@njit(cache=True, nogil=True)
def stiffness_of(give: np.ndarray, stiff: np.ndarray) -> bool:
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
