"""Q-learning of two directions, compiled: rewards of the state space, and random transitions until nothing changes."""

import numpy as np

from rigkit.compiled import njit
from stagectl.planning.strip_kernel import Uncut, is_legal, time_of, without

TWO_DIRECTIONS = 4
ROUND = 10
"""Transitions per state and action between two looks at whether anything still changes."""
SMALLEST = 1e-9
"""A change, of the largest reward, that is none."""


@njit(cache=True, nogil=True)
def _state(way: int, rectangle: Uncut, pocket: np.ndarray) -> int:
    """Return the number of the state in which `way` leaves `rectangle`: side, then feed, then row."""
    row = rectangle[1] if way & 2 else rectangle[0] - 1
    return int(way * pocket[0].rows + row)


@njit(cache=True, nogil=True)
def _reward(
    way: int, k: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray
) -> float:
    """Return minus the time of a strip and the move to it, s; -inf where it is illegal."""
    if not is_legal(way, k, rectangle, pocket):
        return -np.inf
    return -time_of(way, k, last, rectangle, pocket, rate, moves)


@njit(cache=True, nogil=True)
def _after(way: int, k: int, rectangle: Uncut, pocket: np.ndarray) -> int:
    """Return the state after a strip, -1 for the end."""
    rest = without(way, k, rectangle)
    return -1 if rest[0] == rest[1] else _state(way, rest, pocket)


@njit(cache=True, nogil=True)
def rewards(
    last: int,
    rectangle: Uncut,
    pocket: np.ndarray,
    rate: np.ndarray,
    moves: np.ndarray,
    reward: np.ndarray,
    follows: np.ndarray,
) -> None:
    """Set reward and next state by state and action, the state where the tool stands being the last one.

    A state of a side keeps to it, and has milled its side so far that some of `rectangle` is left; from where the tool
    stands, all four corners may be gone to.  An action is a way and a k.
    """
    tool, states = pocket[0].tool, 4 * pocket[0].rows
    reward[:] = -np.inf
    follows[:] = -1
    for way in range(TWO_DIRECTIONS):
        for k in range(1, tool + 1):
            action = way * tool + k - 1
            reward[states, action] = _reward(way, k, last, rectangle, pocket, rate, moves)
            follows[states, action] = _after(way, k, rectangle, pocket)
            for before in (way, way ^ 1):
                rest = rectangle
                while rest[1] - rest[0] > 1:
                    rest = without(way, 1, rest)
                    state = _state(before, rest, pocket)
                    reward[state, action] = _reward(way, k, before, rest, pocket, rate, moves)
                    follows[state, action] = _after(way, k, rest, pocket)


@njit(cache=True, nogil=True)
def train(reward: np.ndarray, follows: np.ndarray, quality: np.ndarray, alpha: float, gamma: float, seed: int) -> int:
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
