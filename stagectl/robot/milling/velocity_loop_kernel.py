"""The compiled kernel of the feed's inner loop: a step of the observer, and the velocity asked of the robot."""

from numba import njit

from rigkit.flush_kernel import flushed

INTEGRAL, FORWARD, LEAST, MOST, PERIOD, SETTINGS = range(6)
"""Of `settings`: L_i, 1/s; l_r, 1; lowest and highest velocity that may be asked for, m/s; s."""


@njit(cache=True, nogil=True)
def observe(state, work, matrices, measured, asked):  # type: ignore[no-untyped-def]
    """Go on to this sample with what was asked before it and what is measured now; return the velocity, m/s.

    `matrices` (n + 4, n): Phi, then Gamma, C, K and L.  Where nothing is measured (not a number) it only predicts.
    """
    n = len(state)
    seen = 0.0
    for i in range(n):
        work[i] = matrices[n, i] * asked
        for j in range(n):
            work[i] += matrices[i, j] * state[j]
        seen += matrices[n + 1, i] * work[i]
    left = measured - seen
    if not left - left == 0.0:  # not finite
        left = 0.0
    velocity = 0.0
    for i in range(n):
        state[i] = flushed(work[i] + matrices[n + 2, i] * left)
        velocity += matrices[n + 1, i] * state[i]
    return velocity


@njit(cache=True, nogil=True)
def control(state, sum_, matrices, settings, wanted, velocity):  # type: ignore[no-untyped-def]
    """Return the velocity asked of the robot (m/s), and the integral for the next sample (m), not wound up.

    `wanted` and `velocity` in m/s; `sum_` in m.
    """
    asked = settings[FORWARD] * wanted - settings[INTEGRAL] * sum_
    for i in range(len(state)):
        asked -= matrices[len(state) + 3, i] * state[i]
    given, error = min(max(asked, settings[LEAST]), settings[MOST]), wanted - velocity
    if (asked - given) * error <= 0.0:  # else it would go on asking for more
        sum_ += settings[PERIOD] * error
    return given, sum_
