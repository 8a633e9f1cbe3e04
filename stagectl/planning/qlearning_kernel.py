"""Q-learning of two directions, compiled: rewards of the state space, and random transitions until nothing changes."""

import numpy as np
from numba import njit

from stagectl.planning.strip_kernel import ROWS, TOOL, is_legal, time_of, without

TWO_DIRECTIONS = 4
ROUND = 10
"""Transitions per state and action between two looks at whether anything still changes."""
SMALLEST = 1e-9
"""A change, of the largest reward, that is none."""


@njit(cache=True, nogil=True)
def _state(way, rectangle, size):  # type: ignore[no-untyped-def]
    """Return the number of the state in which `way` leaves `rectangle`: side, then feed, then row."""
    row = rectangle[1] if way & 2 else rectangle[0] - 1
    return way * size[ROWS] + row


@njit(cache=True, nogil=True)
def _reward(way, k, last, rectangle, size, rate, begin, moves):  # type: ignore[no-untyped-def]
    """Return minus the time of a strip and the move to it, s; -inf where it is illegal."""
    if not is_legal(way, k, rectangle, size):
        return -np.inf
    return -time_of(way, k, last, rectangle, size, rate, begin, moves)


@njit(cache=True, nogil=True)
def _after(way, k, rectangle, size):  # type: ignore[no-untyped-def]
    """Return the state after a strip, -1 for the end."""
    rest = without(way, k, rectangle)
    return -1 if rest[0] == rest[1] else _state(way, rest, size)


@njit(cache=True, nogil=True)
def rewards(last, rectangle, size, rate, begin, moves, reward, follows):  # type: ignore[no-untyped-def]
    """Set reward and next state by state and action, the state where the tool stands being the last one.

    A state of a side keeps to it, and has milled its side so far that some of `rectangle` is left; from where the tool
    stands, all four corners may be gone to.  An action is a way and a k.
    """
    tool, states = size[TOOL], 4 * size[ROWS]
    reward[:] = -np.inf
    follows[:] = -1
    for way in range(TWO_DIRECTIONS):
        for k in range(1, tool + 1):
            action = way * tool + k - 1
            reward[states, action] = _reward(way, k, last, rectangle, size, rate, begin, moves)
            follows[states, action] = _after(way, k, rectangle, size)
            for before in (way, way ^ 1):
                rest = rectangle
                while rest[1] - rest[0] > 1:
                    rest = without(way, 1, rest)
                    state = _state(before, rest, size)
                    reward[state, action] = _reward(way, k, before, rest, size, rate, begin, moves)
                    follows[state, action] = _after(way, k, rest, size)


@njit(cache=True, nogil=True)
def train(reward, follows, quality, alpha, gamma, seed):  # type: ignore[no-untyped-def]
    """Learn Q by (8.1) from random transitions until it changes no more; return how many there were.

    Transitions are drawn among the legal ones, each as likely as any other.
    """
    legal = np.argwhere(reward > -np.inf)
    largest = 0.0
    for n in range(len(legal)):
        largest = max(largest, -reward[legal[n, 0], legal[n, 1]])
    state = np.uint64(2 * seed + 1)
    count = 0
    while True:
        change = 0.0
        for _ in range(ROUND * len(legal)):
            state = state * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
            s, a = legal[(state >> np.uint64(33)) % np.uint64(len(legal))]
            after = follows[s, a]
            best = 0.0 if after < 0 else -np.inf
            if after >= 0:
                for n in range(quality.shape[1]):
                    if reward[after, n] > -np.inf:
                        best = max(best, quality[after, n])
            step = alpha * (reward[s, a] + gamma * best - quality[s, a])
            quality[s, a] += step
            change = max(change, abs(step))
        count += ROUND * len(legal)
        if not change > SMALLEST * largest:
            return count
