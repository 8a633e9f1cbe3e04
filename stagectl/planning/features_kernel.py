"""The two features of chapter 8 and their weights' training, compiled."""

import numpy as np

from rigkit.compiled import njit
from stagectl.planning.strip_kernel import Uncut, breadth, is_legal, time_of, without

FEATURES = 2
LAST = 4
"""Rows or columns of a side from which on its strips are gone through one by one."""
SHARE = 0.01
"""epsilon_1 over epsilon_2."""


@njit(cache=True, nogil=True)
def _last_strips(
    side: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray
) -> tuple[float, int, int]:
    """Return the least time, s, of all that is left off one side, and way and k of the first strip."""
    least, first_way, first_k = np.inf, -1, 0
    broad = breadth(2 * side, rectangle)
    for way in (2 * side, 2 * side + 1):
        for k in range(1, min(pocket[0].tool, broad) + 1):
            if is_legal(way, k, rectangle, pocket):
                time = time_of(way, k, last, rectangle, pocket, rate, moves)
                if k < broad and time < least:
                    rest = without(way, k, rectangle)
                    time += _last_strips(side, way, rest, pocket, rate, moves)[0]
                if time < least:
                    least, first_way, first_k = time, way, k
    return least, first_way, first_k


@njit(cache=True, nogil=True)
def _steady(
    side: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray
) -> tuple[float, int, int]:
    """Return t_me of a side (8.9), s, and way and k of the first strip of its best pair."""
    least, first_way, first_k = np.inf, -1, 0
    broad = breadth(2 * side, rectangle)
    if broad <= 0:
        return 0.0, -1, 0
    if broad <= LAST:
        return _last_strips(side, last, rectangle, pocket, rate, moves)
    for way in (2 * side, 2 * side + 1):
        for k in range(1, min(pocket[0].tool, broad) + 1):
            if not is_legal(way, k, rectangle, pocket):
                continue
            one = time_of(way, k, last, rectangle, pocket, rate, moves)
            if k == broad:
                if one < least:
                    least, first_way, first_k = one, way, k
                continue
            rest = without(way, k, rectangle)
            for second in (2 * side, 2 * side + 1):
                for more in range(1, min(pocket[0].tool, broad - k) + 1):
                    if is_legal(second, more, rest, pocket):
                        steady = time_of(way, k, second, rectangle, pocket, rate, moves)
                        pair = steady + time_of(second, more, way, rest, pocket, rate, moves)
                        whole = one - steady + broad * pair / (k + more)
                        if whole < least:
                            least, first_way, first_k = whole, way, k
    return least, first_way, first_k


@njit(cache=True, nogil=True)
def _turned(
    way: int, k: int, last: int, rectangle: Uncut, pocket: np.ndarray, rate: np.ndarray, moves: np.ndarray
) -> float:
    """Return min(t_d1, t_d2) of a strip, (8.10) and (8.11), s; of one off the side of `last`, t_d2."""
    time = time_of(way, k, last, rectangle, pocket, rate, moves)
    rest = without(way, k, rectangle)
    if k == breadth(way, rectangle):
        return time
    least = np.inf
    if last < 0 or way >> 1 != last >> 1:
        least = _steady(way >> 1, way, rest, pocket, rate, moves)[0]
    for second in range(pocket[0].ways):
        if second >> 1 == way >> 1:
            continue
        for more in range(1, pocket[0].tool + 1):
            if is_legal(second, more, rest, pocket):
                then = time_of(second, more, way, rest, pocket, rate, moves)
                if then < least and more < breadth(second, rest):
                    end = without(second, more, rest)
                    then += _steady(second >> 1, second, end, pocket, rate, moves)[0]
                least = min(least, then)
    return time + least


@njit(cache=True, nogil=True)
def features(
    last: int,
    rectangle: Uncut,
    pocket: np.ndarray,
    rate: np.ndarray,
    moves: np.ndarray,
    scale: float,
    values: np.ndarray,
) -> None:
    """Set F_1, t(a), and F_2, T_Sigma(a) of (8.12), of every strip, by `scale`, 1/s; infinite where it is illegal."""
    values[:] = np.inf
    for way in range(pocket[0].ways):
        for k in range(1, pocket[0].tool + 1):
            if is_legal(way, k, rectangle, pocket):
                values[way, k - 1, 0] = SHARE * scale * time_of(way, k, last, rectangle, pocket, rate, moves)
                values[way, k - 1, 1] = scale * _turned(way, k, last, rectangle, pocket, rate, moves)
    if last >= 0:
        whole, way, k = _steady(last >> 1, last, rectangle, pocket, rate, moves)
        if way >= 0:
            values[way, k - 1, 1] = min(scale * whole, values[way, k - 1, 1])


@njit(cache=True, nogil=True)
def choose(values: np.ndarray, weights: np.ndarray) -> tuple[float, int, int]:
    """Return the largest Q, and way and k of its strip: (8.3) and (8.4)."""
    best, best_way, best_k = -np.inf, -1, 0
    for way in range(values.shape[0]):
        for k in range(values.shape[1]):
            if np.isfinite(values[way, k, 1]):
                quality = weights[0] * values[way, k, 0] + weights[1] * values[way, k, 1]
                if quality > best:
                    best, best_way, best_k = quality, way, k + 1
    return best, best_way, best_k


@njit(cache=True, nogil=True)
def episode(
    last: int,
    rectangle: Uncut,
    first: int,
    pocket: np.ndarray,
    rate: np.ndarray,
    moves: np.ndarray,
    weights: np.ndarray,
    learning: tuple[float, float, float],
) -> None:
    """Go to the end of the pocket once, the `first`-th legal strip first, and move the weights by (8.5) and (8.6).

    `learning`: what a second is worth, 1/s, the rate, and the discount.
    """
    scale, alpha, gamma = learning
    values = np.empty((rate.shape[0], rate.shape[1], FEATURES))
    features(last, rectangle, pocket, rate, moves, scale, values)
    legal = np.argwhere(np.isfinite(values[:, :, 1]))
    at = legal[first % len(legal)]
    way, k = at[0], at[1] + 1
    while True:
        taken = values[way, k - 1].copy()
        reward = -scale * time_of(way, k, last, rectangle, pocket, rate, moves)
        is_end = k == breadth(way, rectangle)
        rectangle, last = without(way, k, rectangle), way
        quality = weights[0] * taken[0] + weights[1] * taken[1]
        best = 0.0
        if not is_end:
            features(last, rectangle, pocket, rate, moves, scale, values)
            best, way, k = choose(values, weights)
        error = reward + gamma * best - quality
        for n in range(FEATURES):
            weights[n] = min(weights[n] + alpha * error * taken[n], 0.0)
        if is_end:
            return
