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
    seen, pushed = _paired(modes, outlet @ modes.basis), _paired(modes, np.linalg.solve(modes.basis, entering).T)
    of_modes = (seen.conj()[:, None] * pushed).reshape(len(outlet), -1)
    weights = np.concatenate([of_modes.real, of_modes.imag], axis=1).T
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
    seen, (outputs, order) = _paired(modes, outlet @ modes.basis), outlet.shape
    drives = len(records[0].products) // (2 * len(modes.poles) + 1) - 1
    own = np.arange(order * drives, order * (drives + 1))
    shared = np.delete(np.arange(order * (drives + 1) + terms.columns(0, outputs, drives).shape[1]), own)
    normal, right, left, pieces = np.zeros((len(shared), len(shared))), np.zeros(len(shared)), 0.0, []
    for record in records:
        whole, sides = _normal_equations(modes, seen, record, terms)
        inverse, mixed = _inverse(whole[np.ix_(own, own)]), whole[np.ix_(own, shared)]
        pieces.append((inverse, mixed, sides[own]))
        normal += whole[np.ix_(shared, shared)] - mixed.T @ inverse @ mixed
        right += sides[shared] - mixed.T @ inverse @ sides[own]
        left += float(np.trace(record.power)) - float(sides[own] @ inverse @ sides[own])
    found = _inverse(normal) @ right
    states = tuple(modes.basis @ (inverse @ (side - mixed @ found)) for inverse, mixed, side in pieces)
    inlet = modes.basis @ found[: order * drives].reshape(drives, order).T
    through, level = terms.split(found[order * drives :], outputs, drives)
    return Regression(inlet, through, level, states, max(0.0, left - float(found @ right)))


def _normal_equations(modes: Modal, seen: np.ndarray, record: Sums, terms: Terms) -> tuple[np.ndarray, np.ndarray]:
    """Return sums of products of regressors (inlets, first state, other terms) with each other and with the targets.

    A pair's regressors in an output are real and imaginary part of w f, with how the output sees it, w, and the
    filter's complex response f: all products follow from those of f with f and with its conjugate.
    """
    outputs, count = seen.shape
    channels = len(record.products) // (2 * count + 1)
    real, imaginary, beside = np.split(np.arange(len(record.products)), [channels * count, 2 * channels * count])
    filtered = (record.products[real] + 1j * record.products[imaginary]).reshape(channels, count, -1)
    with_real, with_imaginary = (
        filtered[..., each].reshape(channels, count, channels, count) for each in (real, imaginary)
    )
    plain = (seen.T @ seen)[:, None] * (with_real + 1j * with_imaginary)
    conjugate = (seen.T @ seen.conj())[:, None] * (with_real - 1j * with_imaginary)
    half = _unpaired(modes, (plain + conjugate) / 2, (plain - conjugate) / 2j)
    half = half.reshape(channels, count, -1).transpose(2, 0, 1)
    states = _unpaired(modes, half.real, half.imag).reshape(half.shape[0], -1)

    columns = [terms.columns(output, outputs, channels - 1) for output in range(outputs)]
    targets = (record.targets[real] + 1j * record.targets[imaginary]).reshape(channels, count, outputs)
    crossed = [weight[:, None] * (filtered[..., beside] @ each) for weight, each in zip(seen, columns, strict=True)]
    others, told = np.moveaxis(sum(crossed), 2, 0), np.einsum("om,cmo->cm", seen, targets)
    mixed = _unpaired(modes, others.real, others.imag).reshape(len(others), len(states))
    rest = sum(each.T @ record.products[np.ix_(beside, beside)] @ each for each in columns)
    sides = sum(each.T @ record.targets[beside, output] for output, each in enumerate(columns))
    whole = np.block([[states, mixed.T], [mixed, np.asarray(rest)]])
    return whole, np.concatenate([_unpaired(modes, told.real, told.imag).ravel(), np.asarray(sides)])


def _paired(modes: Modal, rows: np.ndarray) -> np.ndarray:
    """Return what belongs to the two states of each pair as a complex number: from shape (..., n) to (..., modes)."""
    result, pair = rows[..., modes.first].astype(complex), modes.is_complex
    result[..., pair] += 1j * rows[..., modes.first[pair] + 1]
    return result


def _unpaired(modes: Modal, real: np.ndarray, imaginary: np.ndarray) -> np.ndarray:
    """Return what belongs to each state, from the parts of what belongs to a mode: from (..., modes) to (..., n)."""
    pair = modes.is_complex
    result = np.empty((*real.shape[:-1], len(modes.basis)), np.result_type(real))
    result[..., modes.first] = real
    result[..., modes.first[pair] + 1] = imaginary[..., pair]
    return result


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Invert normal equations; what they do not determine becomes zero."""
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    weights = np.outer(scale, scale)
    inverse: np.ndarray = np.linalg.pinv(matrix / weights, rcond=_RANK, hermitian=True) / weights
    return inverse
