"""G while a shot lasts: how a drive acts at the ends of a shot, and in slow swings between them."""

from collections.abc import Callable

import numpy as np
from scipy import fft

ENDS = 0.2
"""s, over which what is special at an end of a shot fades, along half a Hann window; at most a quarter of the shot."""
ROOM = 1.25
"""Times the lines, transformed, so that the first line's neighbours are not the last ones."""
COLUMNS = 9
"""A row of G and its variations is to have no more: a line and its neighbours say no more than that in a shot."""
ROUNDS = 6
"""Of conjugate gradients: more does not make shots better."""


class Variation:
    """Weighs a drive in time, so that a G that changes while a sweep goes by is a steady one for several drives.

    While the reference fades in and out, joints stick that slide in between; what builds up at the start, and what
    still rings at the end, is cut off; and between the ends, stiffness swings with the size of motion.  So, at each
    moment t, G(t) = G + sum over j of w_j(t) H_j, with w_j of mean 0: what is special at the start and at the end, and
    a cosine and a sine of 1, 2, ... periods in a shot.  In lines that is Y = G U + sum over j of H_j F[w_j u].

    Parameters
    ----------
    frequency : array, shape (lines,), Hz, even
        Their spacing is one over the length of a shot.
    swings : int, >= 0
        Periods in a shot of the fastest swing; 0 for the ends alone.
    """

    def __init__(self, frequency: np.ndarray, swings: int) -> None:
        self._size = int(fft.next_fast_len(int(ROOM * len(frequency)) + 1))
        length = 1.0 / (frequency[1] - frequency[0])
        turn = np.arange(self._size) / self._size
        fade = np.minimum(turn * length / min(ENDS, length / 4), 1.0)
        start = 0.5 + 0.5 * np.cos(np.pi * fade)
        waves = [wave(2 * np.pi * j * turn) for j in range(1, swings + 1) for wave in (np.cos, np.sin)]
        weights = np.stack([start, start[::-1], *waves])
        self.weights = weights - weights.mean(axis=1, keepdims=True)

    def parts(self, drive: np.ndarray) -> np.ndarray:
        """Return lines (lines, inputs), V s, and beside them those of each weighed drive, (lines, parts x inputs)."""
        moments = fft.ifft(drive, self._size, axis=0)[:, None] * self.weights.T[..., None]
        weighed = fft.fft(moments, axis=0)[: len(drive)]
        return np.concatenate([drive, weighed.reshape(len(drive), -1)], axis=1)

    def gathered(self, parts: np.ndarray) -> np.ndarray:
        """Apply the adjoint of `parts`: lines (lines, parts x inputs), any unit, to lines (lines, inputs)."""
        lines, count = len(parts), len(self.weights)
        shaped = parts.reshape(lines, count + 1, -1)
        moments = (fft.ifft(shaped[:, 1:], self._size, axis=0) * self.weights.T[..., None]).sum(axis=1)
        together: np.ndarray = shaped[:, 0] + fft.fft(moments, axis=0)[:lines]
        return together


def swings_of(inputs: int) -> int | None:
    """Return how many swings fit beside the ends into a row of `COLUMNS`; None where not even the ends do.

    Examples
    --------
    >>> [swings_of(inputs) for inputs in (1, 2, 4)]
    [3, 0, None]
    """
    parts = COLUMNS // inputs
    return (parts - 3) // 2 if parts >= 3 else None


def solved(
    respond: Callable[[np.ndarray], np.ndarray],
    adjoint: Callable[[np.ndarray], np.ndarray],
    inverse: np.ndarray,
    wanted: np.ndarray,
    weight: np.ndarray,
) -> np.ndarray:
    """Find the change of drive that changes the response as wanted, where each line is heard at others, too.

    Conjugate gradients on the least squares || W (wanted - respond(G^+ z)) ||, from z = wanted on: where a line's own
    part is smaller than what it hears of others, as in a deep notch, G^+ line by line would not converge.

    Parameters
    ----------
    respond : callable
        From a drive (lines, inputs), V s, to what it makes, (lines, outputs), m/s^2 s; linear.
    adjoint : callable
        Its adjoint.
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        G^+; 0 on lines whose drive stays.
    wanted : complex array, shape (lines, outputs), m/s^2 s
    weight : array, shape (outputs,), 1
        W, those of G^+.

    Returns
    -------
    complex array, shape (lines, inputs), V s
    """
    turned = inverse.conj().swapaxes(-1, -2)
    answer = wanted
    left = weight * (wanted - respond(_applied(inverse, answer)))
    slope = _applied(turned, adjoint(weight * left))
    direction, steepness = slope, np.vdot(slope, slope).real
    for _ in range(ROUNDS):
        made = weight * respond(_applied(inverse, direction))
        power = np.vdot(made, made).real
        if power == 0.0:
            break
        answer = answer + steepness / power * direction
        left = left - steepness / power * made
        slope = _applied(turned, adjoint(weight * left))
        before, steepness = steepness, np.vdot(slope, slope).real
        direction = slope + steepness / before * direction
    return _applied(inverse, answer)


def _applied(matrix: np.ndarray, lines: np.ndarray) -> np.ndarray:
    product: np.ndarray = (matrix @ lines[..., None])[..., 0]
    return product
