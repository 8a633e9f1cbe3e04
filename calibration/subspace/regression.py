"""What drives a model's states, by least squares on its response, in the model's own coordinates and without sums."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq, qr

from calibration.state_space import model_kernel

_CHUNK = 4096
"""Samples simulated and folded into the triangle at a time."""
_RANK = 1e-12
"""Directions weaker than this part of the strongest are left at zero."""


@dataclass(frozen=True)
class Terms:
    """What is fitted besides inlets and first states.

    Parameters
    ----------
    direct : bool
        A direct term from each drive to each output.
    constant : bool
        A constant in each output, the same for all records.
    stable : bool, optional
        Poles are kept inside of the unit circle.
    fed_back : bool, optional
        Inputs follow from outputs: then the error one step ahead alone tells a response from noise.
    """

    direct: bool
    constant: bool
    stable: bool = True
    fed_back: bool = False

    def columns(self, output: int, outputs: int, drives: int) -> np.ndarray:
        """Return what one output's terms take of the drives and of a constant 1: shape (drives + 1, terms).

        Terms: for each output those of the drives, then each output's constant.
        """
        through, level = outputs * drives * self.direct, outputs * self.constant
        result = np.zeros((drives + 1, through + level))
        if self.direct:
            result[:drives, output * drives : (output + 1) * drives] = np.eye(drives)
        if self.constant:
            result[drives, through + output] = 1.0
        return result

    def split(self, found: np.ndarray, outputs: int, drives: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the direct term and the constants, shapes (outputs, drives) and (outputs,), zero where not fitted.

        Parameters
        ----------
        found : array, shape (terms,), any unit
        outputs, drives : int
        """
        through = outputs * drives * self.direct
        direct = found[:through].reshape(outputs, drives) if self.direct else np.zeros((outputs, drives))
        return direct, found[through:] if self.constant else np.zeros(outputs)


@dataclass(frozen=True)
class Regression:
    """What a least squares fit found.

    Parameters
    ----------
    inlet : array, shape (n, drives), 1 per the drives' units
        How each drive enters the states, in the model's own coordinates.
    direct : array, shape (p, drives), the outputs' per the drives' units
    constant : array, shape (p,), the outputs' units
    states : tuple of arrays, each of shape (n,), 1
        At the start of each record.
    left : float
        Sum of squares left.
    """

    inlet: np.ndarray
    direct: np.ndarray
    constant: np.ndarray
    states: tuple[np.ndarray, ...]
    left: float


def regress_columns(
    transition: np.ndarray,
    outlet: np.ndarray,
    drives: Sequence[np.ndarray],
    targets: Sequence[np.ndarray],
    terms: Terms,
) -> Regression:
    """Fit inlet, first states and what else there is together, each coefficient's response simulated by itself.

    Slower than `modal_regression.regress`, and right where that is not: where poles (nearly) coincide, and where a
    response is explained to more digits than sums of squares keep.

    Parameters
    ----------
    transition : array, shape (n, n), 1
    outlet : array, shape (p, n), any unit
    drives : sequence of arrays, each of shape (N, drives), any unit
    targets : sequence of arrays, each of shape (N, p), any unit
    terms : Terms
    """
    order, outputs, width = len(transition), len(outlet), drives[0].shape[1]
    shared = order * width + terms.columns(0, outputs, width).shape[1]
    common = np.zeros((0, shared + 1))
    own = []
    for drive, target in zip(drives, targets, strict=True):
        triangle = np.zeros((0, order + shared + 1))
        for rows in _rows(transition, outlet, drive, target, terms):
            triangle = qr(np.concatenate([triangle, rows]), mode="r", overwrite_a=True)[0][: order + shared + 1]
        own.append(triangle[:order])
        common = qr(np.concatenate([common, triangle[order:, order:]]), mode="r")[0][: shared + 1]
    found = lstsq(common[:, :shared], common[:, shared], cond=_RANK)[0]
    states = tuple(
        lstsq(top[:, :order], top[:, -1] - top[:, order:-1] @ found, cond=_RANK)[0] if order else np.zeros(0)
        for top in own
    )
    left = common[:, shared] - common[:, :shared] @ found
    inlet = found[: order * width].reshape(width, order).T
    through, level = terms.split(found[order * width :], outputs, width)
    return Regression(inlet, through, level, states, float(left @ left))


def _rows(
    transition: np.ndarray, outlet: np.ndarray, drive: np.ndarray, target: np.ndarray, terms: Terms
) -> Iterator[np.ndarray]:
    """Give the regression's rows a stretch of time at a time: first state, inlet, other terms, what is explained."""
    order, outputs, width = len(transition), len(outlet), drive.shape[1]
    matrices = transition.T.copy(), outlet.T.copy(), np.zeros((1, outputs))
    inlets = [np.zeros((1, order))] * order + [unit[None].copy() for _ in range(width) for unit in np.eye(order)]
    channels = [0] * order + [channel for channel in range(width) for _ in range(order)]
    states = [*np.eye(order)] + [np.zeros(order) for _ in range(order * width)]
    for start in range(0, len(drive), _CHUNK):
        pushed, wanted = drive[start : start + _CHUNK], target[start : start + _CHUNK]
        columns = np.empty((len(inlets), *wanted.shape))
        for inlet, channel, state, column in zip(inlets, channels, states, columns, strict=True):
            push = pushed[:, channel : channel + 1].copy()
            model_kernel.free_run(matrices[0], inlet, matrices[1], matrices[2], push, state, column)
        beside = np.concatenate([pushed, np.ones((len(pushed), 1))], axis=1)
        others = np.stack([beside @ terms.columns(output, outputs, width) for output in range(outputs)], axis=1)
        flat = len(pushed) * outputs
        yield np.concatenate([columns.reshape(-1, flat).T, others.reshape(flat, -1), wanted.reshape(flat, 1)], axis=1)
