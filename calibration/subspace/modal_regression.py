"""Least squares on a model's response, linear in what drives its states, by the modes' own responses."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from calibration.subspace import filter_kernel
from calibration.subspace.modal import Modal
from calibration.subspace.regression import Regression, Terms

_CHUNK = 1024
"""Samples filtered and folded into the sums at a time."""
_RANK = 1e-13
"""Directions of scaled normal equations weaker than this part of the strongest are left at zero."""


@dataclass(frozen=True)
class Sums:
    """Sums over time of products of a record's regression signals.

    Parameters
    ----------
    products : array, shape (signals, signals), products of the signals' units
        Signals: the real, then the imaginary part of each mode's response to each drive and, as if to one more drive,
        its free decay from 1; then the drives; then a constant 1.
    targets : array, shape (signals, p), products of the signals' units
        With each output to be explained.
    power : array, shape (p, p), products of the outputs' units
        Of the outputs to be explained.
    """

    products: np.ndarray
    targets: np.ndarray
    power: np.ndarray


def sums(modes: Modal, drive: np.ndarray, target: np.ndarray) -> Sums:
    """Filter a record's drive through the modes and sum products over time.

    Parameters
    ----------
    modes : Modal
    drive : array, shape (N, drives), any unit
    target : array, shape (N, p), any unit
        What is to be explained.
    """
    drives = drive.shape[1]
    filtered = 2 * len(modes.poles) * (drives + 1)
    width = drives + 1 + target.shape[1]
    products = np.zeros((filtered + width, filtered + width))
    for start, block in _blocks(modes, drive, 1, width):
        block[:, filtered : filtered + drives] = drive[start : start + len(block)]
        block[:, filtered + drives] = 1.0
        block[:, filtered + drives + 1 :] = target[start : start + len(block)]
        products += block.T @ block
    signals = filtered + drives + 1
    return Sums(products[:signals, :signals], products[:signals, signals:], products[signals:, signals:])


def responses(modes: Modal, outlet: np.ndarray, inlet: np.ndarray, drive: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Return the outputs' response to a drive and a first state, without a direct term: shape (N, p).

    Parameters
    ----------
    modes : Modal
    outlet : array, shape (p, n), any unit
    inlet : array, shape (n, drives), 1 per the drive's units
    drive : array, shape (N, drives), any unit
    state : array, shape (n,), 1
    """
    decays = int(np.any(state))
    entering = np.concatenate([inlet, state[:, None]], axis=1) if decays else inlet
    coefficients = np.linalg.solve(modes.basis, entering).T.ravel()
    maps = [_modal_map(modes, seen, entering.shape[1]) @ coefficients for seen in outlet @ modes.basis]
    weights = np.stack(maps, axis=1)
    result = np.empty((len(drive), len(outlet)))
    for start, block in _blocks(modes, drive, decays, 0):
        np.matmul(block, weights, out=result[start : start + len(block)])
    return result


def _blocks(modes: Modal, drive: np.ndarray, decays: int, spare: int) -> Iterator[tuple[int, np.ndarray]]:
    """Give stretches of the filters' parts, with 0 or 1 free decays and spare columns; each overwrites the last one."""
    count, drives = len(modes.poles), drive.shape[1]
    state = np.zeros((2, (drives + decays) * count))
    state[0, drives * count :] = 1.0
    block = np.empty((_CHUNK, 2 * count * (drives + decays) + spare))
    pushed = np.zeros((_CHUNK, drives + decays))
    real, imaginary = modes.poles.real.copy(), modes.poles.imag.copy()
    for start in range(0, len(drive), _CHUNK):
        rows = min(_CHUNK, len(drive) - start)
        pushed[:rows, :drives] = drive[start : start + rows]
        filter_kernel.modal_responses(real, imaginary, pushed[:rows], state, block[:rows])
        yield start, block[:rows]


def regress(modes: Modal, outlet: np.ndarray, records: Sequence[Sums], terms: Terms) -> Regression:
    """Fit inlet, each record's first state and what else there is together.

    Parameters
    ----------
    modes : Modal
    outlet : array, shape (p, n), any unit
        C, in the model's own coordinates.
    records : sequence of Sums
    terms : Terms
    """
    seen = outlet @ modes.basis
    outputs, order = seen.shape
    drives = (len(records[0].products) - 1 - 2 * len(modes.poles)) // (2 * len(modes.poles) + 1)
    maps = [_regressors(modes, seen, output, drives, terms) for output in range(outputs)]
    shared = maps[0].shape[1] - order
    normal, right, left, pieces = np.zeros((shared, shared)), np.zeros(shared), 0.0, []
    for record in records:
        whole = sum(each.T @ record.products @ each for each in maps)
        sides = sum(each.T @ record.targets[:, output] for output, each in enumerate(maps))
        inverse = _inverse(whole[shared:, shared:])
        pieces.append((inverse, whole[shared:, :shared], sides[shared:]))
        normal += whole[:shared, :shared] - whole[:shared, shared:] @ inverse @ whole[shared:, :shared]
        right += sides[:shared] - whole[:shared, shared:] @ inverse @ sides[shared:]
        left += float(np.trace(record.power)) - float(sides[shared:] @ inverse @ sides[shared:])
    found = _inverse(normal) @ right
    states = tuple(modes.basis @ (inverse @ (side - mixed @ found)) for inverse, mixed, side in pieces)
    inlet = modes.basis @ found[: order * drives].reshape(drives, order).T
    through, level = terms.split(found[order * drives :], outputs, drives)
    return Regression(inlet, through, level, states, max(0.0, left - float(found @ right)))


def _regressors(modes: Modal, seen: np.ndarray, output: int, drives: int, terms: Terms) -> np.ndarray:
    """Return how an output's regressors (inlets, other terms, first state) are made of the signals of `Sums`."""
    outputs, order = seen.shape
    filtered = _modal_map(modes, seen[output], drives + 1)
    others = terms.columns(output, outputs, drives)
    result = np.zeros((len(filtered) + drives + 1, order * (drives + 1) + others.shape[1]))
    result[: len(filtered), : order * drives] = filtered[:, : order * drives]
    result[: len(filtered), order * drives + others.shape[1] :] = filtered[:, order * drives :]
    result[len(filtered) :, order * drives : order * drives + others.shape[1]] = others
    return result


def _modal_map(modes: Modal, seen: np.ndarray, channels: int) -> np.ndarray:
    """Return how outputs follow from inlets, channel by channel: shape (2 channels modes, channels n).

    Of a pair, x1 - j x2 = (b1 - j b2) f with the filter's complex response f.
    """
    count, order = len(modes.poles), len(seen)
    half = count * channels
    result = np.zeros((2 * half, channels * order))
    pair = modes.is_complex
    for channel in range(channels):
        row, column = channel * count + np.arange(count), channel * order + modes.first
        result[row, column] = seen[modes.first]
        row, column, first = row[pair], column[pair], modes.first[pair]
        result[half + row, column] = -seen[first + 1]
        result[row, column + 1] = seen[first + 1]
        result[half + row, column + 1] = seen[first]
    return result


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Invert normal equations; what they do not determine becomes zero."""
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    weights = np.outer(scale, scale)
    inverse: np.ndarray = np.linalg.pinv(matrix / weights, rcond=_RANK, hermitian=True) / weights
    return inverse
