"""The compiled kernel of the feed's inner loop: a step of the observer, and the velocity asked of the robot."""

import numpy as np

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record


@njit(cache=True, nogil=True)
def foreseen(loop: Record, n: int, asked: float, state: np.ndarray, work: np.ndarray) -> float:
    """Put the state after `asked`, m/s, of the first `n` states into `work`; return the velocity then, m/s."""
    velocity = 0.0
    for i in range(n):
        ahead = loop.inlet[i] * asked
        for j in range(n):
            ahead += loop.transition[i, j] * state[j]
        work[i] = ahead
        velocity += loop.outlet[i] * ahead
    return velocity


@njit(cache=True, nogil=True)
def observe(loop: Record, measured: float) -> float:
    """Go on to this sample with what was asked before it and what is measured now (m/s); return the velocity, m/s.

    Where nothing is measured (not a number) it only predicts.
    """
    n = loop.states
    left = measured - foreseen(loop, n, loop.asked, loop.state, loop.work)
    if not left - left == 0.0:  # not finite
        left = 0.0
    velocity = 0.0
    for i in range(n):
        loop.state[i] = flushed(loop.work[i] + loop.gain[i] * left)
        velocity += loop.outlet[i] * loop.state[i]
    return velocity


@njit(cache=True, nogil=True)
def control(loop: Record, wanted: float, velocity: float) -> None:
    """Set the velocity asked of the robot, and the integral for the next sample, not wound up.

    `wanted` and `velocity` in m/s.
    """
    asked = loop.forward * wanted - loop.integral * loop.integrated
    for i in range(loop.states):
        asked -= loop.feedback[i] * loop.state[i]
    given, error = min(max(asked, loop.least), loop.most), wanted - velocity
    if (asked - given) * error <= 0.0:  # else it would go on asking for more
        loop.integrated += loop.period * error
    loop.asked = given


@njit(cache=True, nogil=True)
def begin(loop: Record, wanted: float) -> None:
    """Go on from another control of the velocity: ask for `wanted`, m/s, in this sample, with that wanted."""
    asked = loop.forward * wanted
    for i in range(loop.states):
        asked -= loop.feedback[i] * loop.state[i]
    loop.asked = min(max(wanted, loop.least), loop.most)
    loop.integrated = (asked - loop.asked) / loop.integral


@njit(cache=True, nogil=True)
def rest(loop: Record) -> None:
    """Ask for nothing, and forget what was integrated."""
    loop.asked = loop.integrated = 0.0
