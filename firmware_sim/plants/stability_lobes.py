"""From which depth on a slot chatters: the limit of stability by the mean of the teeth's directions."""

import numpy as np

from firmware_sim.plants.tooth_cut import ToolMode

POINTS = 3_000
"""Frequencies that are looked at, from a half of the lowest mode's to three times the highest's."""


def depth_limit(mode: ToolMode, tangential: float, radial: float, teeth: int, spindle: float) -> float:
    """Return the depth, m, from which on a slot over the whole width of the tool chatters; infinite if none does.

    The force of all teeth answers how far the tool is from where it was a tooth before, D = (1 - exp(-i w / (N n))) r,
    by K_t a N / 4 B D with B = [[-K_r, -1], [1, -K_r]], the mean over half a turn.  On the limit an eigenvalue l of B
    times the tool's response has a = 2 / (K_t N Re l), where the phase of 1 - 4 / (K_t N a l) is that of the delay.

    Parameters
    ----------
    mode : ToolMode
    tangential : float, N/m^2, K_t, of a law that is linear in the chip
    radial : float, 1, K_r, the radial force over the tangential one
    teeth : int, N
    spindle : float, Hz, n

    Source
    ------
    Altintas and Budak, Ann. CIRP 44 (1995) 357; Altintas, Manufacturing Automation, 2nd ed., sec. 4.5.
    """
    omega = 2 * np.pi * np.geomspace(0.5 * min(mode.frequency), 3.0 * max(mode.frequency), POINTS)
    own = [2 * np.pi * each for each in mode.frequency]
    x, y = (
        natural**2 / stiffness / (natural**2 - omega**2 + 2j * damping * natural * omega)
        for natural, damping, stiffness in zip(own, mode.damping, mode.stiffness, strict=True)
    )
    half, product = -0.5 * radial * (x + y), (1.0 + radial**2) * x * y
    root = np.sqrt(half**2 - product + 0j)
    limit = np.inf
    for answer in (half + root, half - root):
        answers = answer.real > 0.0
        depth = 2.0 / (tangential * teeth * np.where(answers, answer.real, np.nan))
        turned = -np.angle(1.0 - 2.0 * answer.real / answer)  # 4 / (K_t N a l) with that a
        late = np.exp(1j * (omega / (teeth * spindle) - turned))
        crossed = (late.imag[1:] * late.imag[:-1] <= 0.0) & (late.real[1:] > 0.0) & answers[1:] & answers[:-1]
        limit = min([limit, *depth[1:][crossed]])
    return float(limit)
