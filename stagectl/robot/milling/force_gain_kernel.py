"""The compiled kernel that solves the outer LQI problem in closed form, every sample anew."""

import cmath
import math

from rigkit.compiled import njit
from rigkit.record import Record

Cubic = tuple[float, float, float, float]
"""Coefficients from the third power down."""
FASTEST = 8.0
"""Decay of the force in a sample, 1: its logarithm."""


@njit(cache=True, nogil=True)
def _held(x: float) -> float:
    """Return (e^x - 1) / x."""
    return math.expm1(x) / x if abs(x) > 1e-12 else 1.0


@njit(cache=True, nogil=True)
def _flow(kappa: float, widening: float, outer: Record) -> tuple[float, float]:
    """Return how quickly the force decays, 1/s, and how much of it a feed makes, N/m.

    A force that has decayed within a sample is taken for one that decays by e^-FASTEST in it, with the same gain at
    rest: a quicker one leaves next to nothing in the numbers, and the cubic loses its leading coefficient.
    """
    decay, most = outer.stiffness * kappa, FASTEST / outer.period
    if decay <= most:
        return decay, outer.stiffness * widening
    return most, most * widening / kappa


@njit(cache=True, nogil=True)
def sampled(kappa: float, widening: float, outer: Record) -> Cubic:
    """Return the sampled process: 1 - a, 1 - e, and n0, n1 of its numerator n0 + n1 (z - 1), N per m/s.

    The velocity loop has the pole a, the force e; from velocity reference to force is n / ((z - a) (z - e)).
    """
    h, lag = outer.period, outer.lag
    decay, gain = _flow(kappa, widening, outer)
    slow_v, slow_f = -math.expm1(-h * lag), -math.expm1(-h * decay)
    through = gain * h * math.exp(-h * decay) * _held(h * (decay - lag))  # of a velocity, after a sample
    direct = gain * h * _held(-h * decay) - through  # of a reference, within the sample
    return slow_v, slow_f, through * slow_v + direct * slow_v, direct


@njit(cache=True, nogil=True)
def control_weight(kappa: float, widening: float, outer: Record) -> float:
    """Return the weight of the feed, (N s/m)^2: relative to the force that it makes at the integral's frequency.

    So the loop is about as quick for every kappa.
    """
    decay, gain = _flow(kappa, widening, outer)
    weight: float = outer.control * gain * gain / (decay * decay + outer.integral)
    return weight


@njit(cache=True, nogil=True)
def _spectrum(process: Cubic, weight: float, outer: Record) -> Cubic:
    """Return the cubic in s = |z - 1|^2 whose roots are the closed loop's: its coefficients from s^3 down.

    On the unit circle |z - a|^2 = (1 - a)^2 + a s, |n|^2 = n0^2 - n1 (n0 - n1) s.
    """
    slow_v, slow_f, n0, n1 = process
    h = outer.period
    v0, v1 = slow_v * slow_v, 1.0 - slow_v
    f0, f1 = slow_f * slow_f, 1.0 - slow_f
    m0, m1 = n0 * n0, -n1 * (n0 - n1)
    rate, speed = outer.integral * h * h, outer.velocity * v0
    return (
        weight * v1 * f1,
        weight * (v0 * f1 + v1 * f0) + m1 + speed * f1,
        weight * v0 * f0 + m0 + rate * m1 + speed * f0,
        rate * m0,
    )


@njit(cache=True, nogil=True)
def _real_root(c3: float, c2: float, c1: float, c0: float) -> float:
    """Return a real root of a cubic by Cardano's formula, polished by Newton's method."""
    p2, p1, p0 = c2 / c3, c1 / c3, c0 / c3
    q = (3.0 * p1 - p2 * p2) / 9.0
    r = (9.0 * p2 * p1 - 27.0 * p0 - 2.0 * p2**3) / 54.0
    inside = q**3 + r * r
    if inside >= 0.0:
        t = math.copysign((abs(r) + math.sqrt(inside)) ** (1.0 / 3.0), r)
        root = (t - q / t if t != 0.0 else 0.0) - p2 / 3.0
    else:  # three of them; the one furthest out
        turn = math.acos(min(max(abs(r) / math.sqrt(-(q**3)), -1.0), 1.0)) / 3.0
        root = math.copysign(2.0 * math.sqrt(-q) * math.cos(turn), r) - p2 / 3.0
    for _ in range(3):
        slope = (3.0 * root + 2.0 * p2) * root + p1
        if slope != 0.0:
            root -= (((root + p2) * root + p1) * root + p0) / slope
    return root


@njit(cache=True, nogil=True)
def _inside(s: complex) -> complex:
    """Return z - 1 for the one of z + 1 / z = 2 - s that lies within the unit circle."""
    half = 0.5 * cmath.sqrt(s * s - 4.0 * s)
    one, other = -0.5 * s + half, -0.5 * s - half
    far = one if abs(one) > abs(other) else other
    near = s / far  # their product is s, without cancellation
    return far if abs(1.0 + far) < abs(1.0 + near) else near


@njit(cache=True, nogil=True)
def _poles(cubic: Cubic) -> tuple[complex, complex, complex]:
    """Return z - 1 of the three poles of the closed loop."""
    c3, c2, c1, c0 = cubic
    first = _real_root(c3, c2, c1, c0)
    last = -c0 / (c3 * first)
    if abs(first) ** 3 * c3 > c0:  # far out: divide it off from below, so that nothing cancels
        middle = (last - c1 / c3) / first
    else:
        middle = c2 / c3 + first
    half = 0.5 * cmath.sqrt(middle * middle - 4.0 * last + 0j)
    one, other = -0.5 * middle + half, -0.5 * middle - half
    far = one if abs(one) > abs(other) else other
    return _inside(first + 0j), _inside(far), _inside(last / far)


@njit(cache=True, nogil=True)
def gains(kappa: float, widening: float, outer: Record) -> tuple[float, float, float]:
    """Return the LQI gains on velocity (1), force (m/(N s)) and the integral of the force's error (m/(N s^2)).

    u = -l_v v - l_f f + l_i (sum of h (f_d - f)).
    """
    slow_v, slow_f, n0, n1 = sampled(kappa, widening, outer)
    weight = control_weight(kappa, widening, outer)
    one, two, three = _poles(_spectrum((slow_v, slow_f, n0, n1), weight, outer))
    p2 = -(one + two + three).real
    p1 = (one * two + two * three + three * one).real
    p0 = -(one * two * three).real
    through = p0 / n0  # l_i h
    least = p1 - slow_v * slow_f - through * n1  # of what l_v and l_f do together
    rest = p2 - slow_v - slow_f
    on_force = (least - slow_f * rest) / (n0 - slow_f * n1)
    return (rest - on_force * n1) / slow_v, on_force, through / outer.period
