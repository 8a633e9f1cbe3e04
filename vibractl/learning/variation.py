"""A drive in time: its edges, and how G acts at the ends of a shot and in slow swings between them."""

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

    What is emitted of a drive's lines U has edges, e(t) u(t), and a line of it some of its neighbours: in lines it is
    F[e u].  A machine that rings for long answers to that loudly, where a small line lies beside large ones.

    While the reference fades in and out, joints stick that slide in between, and between the ends stiffness swings with
    the size of motion.  So, at each moment t, G(t) = G + sum over j of w_j(t) H_j, with w_j of mean 0: what is special
    at the start and at the end, and a cosine and a sine of 1, 2, ... periods in a shot.  In lines that is
    Y = G F[e u] + sum over j of H_j F[w_j e u].

    Parameters
    ----------
    frequency : array, shape (lines,), Hz, even
        Their spacing is one over the length of a shot.
    edge : float, s, >= 0
        Of the drive at both ends, raised cosines.
    rest : float, s, >= 0
        At the end of a shot, in which the drive is silent.
    swings : int, >= 0, or None
        Periods in a shot of the fastest swing; 0 for the ends alone; None where G is steady.
    """

    def __init__(self, frequency: np.ndarray, edge: float, rest: float, swings: int | None) -> None:
        self._size = int(fft.next_fast_len(int(ROOM * len(frequency)) + 1))
        length = 1.0 / (frequency[1] - frequency[0])
        time, sounded = length * np.arange(self._size) / self._size, length - rest
        self.weights = np.zeros((0, self._size)) if swings is None else _swings(time, sounded, swings)
        inside = np.maximum(np.minimum(time, sounded - time), 0.0)
        edges = 0.5 - 0.5 * np.cos(np.pi * np.minimum(inside / edge, 1.0)) if edge else (time < sounded) + 0.0
        self._every = edges * np.concatenate([np.ones((1, self._size)), self.weights])

    def parts(self, drive: np.ndarray) -> np.ndarray:
        """Return what is emitted of lines (lines, inputs), V s, and each part weighed, (lines, parts x inputs)."""
        moments = fft.ifft(drive, self._size, axis=0)[:, None] * self._every.T[..., None]
        weighed: np.ndarray = fft.fft(moments, axis=0)[: len(drive)].reshape(len(drive), -1)
        return weighed

    def gathered(self, parts: np.ndarray) -> np.ndarray:
        """Apply the adjoint of `parts`: lines (lines, parts x inputs), any unit, to lines (lines, inputs)."""
        shaped = parts.reshape(len(parts), len(self._every), -1)
        moments = (fft.ifft(shaped, self._size, axis=0) * self._every.T[..., None]).sum(axis=1)
        together: np.ndarray = fft.fft(moments, axis=0)[: len(parts)]
        return together


def _swings(time: np.ndarray, length: float, swings: int) -> np.ndarray:
    """Return the weights w_j, (parts, moments), of mean 0 over a drive of so many s, of times (moments,), s."""
    during = time < length
    start = 0.5 + 0.5 * np.cos(np.pi * np.minimum(time / min(ENDS, length / 4), 1.0))
    end = np.zeros(len(time))
    end[during] = start[during][::-1]
    waves = [wave(2 * np.pi * j * time / length) for j in range(1, swings + 1) for wave in (np.cos, np.sin)]
    weights = np.stack([start, end, *waves])
    centred: np.ndarray = weights - weights[:, during].mean(axis=1, keepdims=True)
    return centred


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
    rows: np.ndarray, variation: Variation | None, inverse: np.ndarray, wanted: np.ndarray, weight: np.ndarray
) -> np.ndarray:
    """Find the change of drive that changes the response as wanted, where each line is heard at others, too.

    Conjugate gradients on the least squares || W (G G^+ wanted - Y(G^+ z)) ||, from z = wanted on: where a line's own
    part is smaller than what it hears of others, as in a deep notch, G^+ line by line would not converge.  What G^+
    leaves of a line, where G is weak, is left here, too: no other line is to suffer from drives that grow for it.

    Parameters
    ----------
    rows : complex array, shape (lines, outputs, parts x inputs), m/s^2 per V
        G, and beside it what varies.
    variation : Variation or None
        That parts a drive; without it lines are heard at themselves alone.
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        G^+; 0 on lines whose drive stays.
    wanted : complex array, shape (lines, outputs), m/s^2 s
    weight : array, shape (lines, outputs), 1
        W: those of G^+, times how much a line counts.

    Returns
    -------
    complex array, shape (lines, inputs), V s
    """

    def respond(drive: np.ndarray) -> np.ndarray:
        return _applied(rows, variation.parts(drive) if variation else drive)

    def adjoint(response: np.ndarray) -> np.ndarray:
        parts: np.ndarray = np.einsum("loi,lo->li", rows.conj(), response)
        return variation.gathered(parts) if variation else parts

    turned, steady = inverse.conj().swapaxes(-1, -2), rows[..., : inverse.shape[1]]
    answer = wanted
    begin = _applied(inverse, answer)
    left = weight * (_applied(steady, begin) - respond(begin))
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
