"""Dry friction that remembers: Dahl's and the LuGre model, exact over a step in which the velocity is held."""

import math

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def dahl(strain: float, velocity: float, travel: float, step: float) -> float:
    """Return Dahl's friction after a step, as a part of the Coulomb force: -1 to 1.

    ds/dt = v / travel (1 - s sgn v) [Dahl 1968, with exponent 1]; `strain` is s before, `velocity` in m/s, `travel` in
    m is the distance in which friction builds up, `step` in s.
    """
    end = math.copysign(1.0, velocity)
    after: float = flushed(end + (strain - end) * math.exp(-abs(velocity) * step / travel))
    return after


@njit(cache=True, nogil=True)
def stribeck(velocity: float, law: np.ndarray) -> float:
    """Return g(v) = Fc + (Fs - Fc) exp(-(v / vs)^2), N: `law` holds sigma_0, sigma_1, sigma_2, Fc, Fs and vs."""
    ratio: float = velocity / law[5]
    friction: float = law[3] + (law[4] - law[3]) * math.exp(-ratio * ratio)
    return friction


@njit(cache=True, nogil=True)
def lugre(bristle: float, velocity: float, law: np.ndarray, step: float) -> tuple[float, float]:
    """Return the bristles' deflection after a step, m, and the mean force over it, N, without the viscous part.

    dz/dt = v - sigma_0 |v| z / g(v), F = sigma_0 z + sigma_1(v) dz/dt [Canudas de Wit, Olsson, Astrom and Lischinsky,
    IEEE Trans. Automatic Control 40 (1995) 419].  `law` as for `stribeck`: sigma_0 N/m, sigma_1 N s/m.  The bristles'
    damping falls off with speed, sigma_1 exp(-(v / vs)^2), without which the model can give energy [Olsson 1996].
    """
    friction, ratio = stribeck(velocity, law), velocity / law[5]
    pace = law[0] * abs(velocity) / friction * step
    if pace > 1e-9:
        end = math.copysign(friction / law[0], velocity)
        after = end + (bristle - end) * math.exp(-pace)
    else:
        after = bristle + velocity * step - pace * bristle
    damping = law[1] * math.exp(-ratio * ratio)
    return flushed(after), law[0] * 0.5 * (bristle + after) + damping * (after - bristle) / step
