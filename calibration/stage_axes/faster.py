"""A model of thinned records made one at the records' own rate."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from calibration.state_space import model_kernel
from calibration.state_space.model import InnovationModel
from calibration.state_space.modes import frequency_and_damping
from calibration.subspace.gain_refinement import refine_gain
from calibration.subspace.kalman_gain import Gain
from calibration.subspace.regression import Terms
from calibration.subspace.response import fit_response

SLOWEST, FASTEST = 1e-6, 1e-3
"""Least 1 - |z|, and least |z|, of a pole of the thinned model: others are taken there before they are converted."""
RINGING = 0.3
"""Damping ratio up to which a pole is one of the mechanics."""
SLOWEST_MODE, CREEP = 0.02, 0.1
"""Re the rate of the thinned records, a tenth of the highest frequency: what rings more slowly is no resonance.  Of the
lowest resonance: what is slower is creep, hysteresis and the inner loop, which integral action meets."""
CREEP_ALONE = 0.002
"""The same re the rate of the thinned records, where nothing rings."""
BEYOND = 0.25
"""Of the rate of the thinned records: what rings above was not excited, and is noise."""
LAG = 0.5
"""Corner of a stack's lag, re the rate of the thinned records."""


def at_rate(
    model: InnovationModel, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], rate: float
) -> InnovationModel:
    """Convert a model to a higher rate by its poles, and fit how they are driven, and K, to records at that rate.

    Each pole z becomes z^(1/factor), the same continuous pole sampled faster; one on the negative real axis, which no
    continuous system has, |z|^(1/factor).  Modes keep their shapes in C.  B comes by least squares on the free run, so
    that no assumption is made of what the drive does between two samples of the thinned record; D is 0, since a
    voltage that is let out is never seen in the same sample.  K comes by Gauss-Newton steps on the error one step
    ahead.

    Parameters
    ----------
    model : InnovationModel
        Of thinned records.
    drives : sequence of arrays, each of shape (N, m), the inputs' units
        At `rate`, as deviations from the operating point.
    responses : sequence of arrays, each of shape (N, p), the outputs' units
    rate : float, samples/s

    Source
    ------
    Åström and Wittenmark, Computer-Controlled Systems, 3rd ed., 1997, section 2.3 (poles under sampling); Ljung 1999,
    System Identification, 2nd ed., section 13.2 (choice of the sampling interval).
    """
    return _driven(model, _modal(model, rate / model.rate), drives, responses, rate)


def control_at_rate(
    model: InnovationModel, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], rate: float
) -> InnovationModel:
    """Convert a model to a higher rate as `at_rate` does, and keep what a loop is designed on: mechanics and lags.

    Creep and the slope of hysteresis are poles far below the first resonance, often below the lowest frequency that is
    excited, so that their gain at rest, and its sign, are chance.  They help to fit how the others are driven, and are
    left out then: the gain at rest becomes that of the frequencies between them and the resonances, and below it
    integral action sees to the rest.  What rings above the frequencies that were excited is left out before the fit.

    Parameters
    ----------
    model : InnovationModel
        Of thinned records, of one output.
    drives : sequence of arrays, each of shape (N, m), the inputs' units
        At `rate`, as deviations from the operating point.
    responses : sequence of arrays, each of shape (N, 1), the output's unit
    rate : float, samples/s
    """
    found = model.modes
    resonant = (found.frequency >= SLOWEST_MODE * model.rate) & (found.frequency <= BEYOND * model.rate)
    heard = resonant & (found.damping <= RINGING)
    below = CREEP * min(found.frequency[heard], default=CREEP_ALONE / CREEP * model.rate)
    modes = _modal(
        model, rate / model.rate, lambda frequency, damping: damping > RINGING or frequency <= BEYOND * model.rate
    )
    frequency, _ = frequency_and_damping(_poles(modes[0]), rate)
    kept = frequency >= below
    return _driven(model, modes, drives, responses, rate, kept if kept.any() else None)


def stack_at_rate(
    model: InnovationModel, drives: Sequence[np.ndarray], responses: Sequence[np.ndarray], rate: float
) -> InnovationModel:
    """Convert a model of a stack's extension: what follows its voltage at once, with resonances beside it.

    As `at_rate`, but poles that hardly ring, or ring more slowly than any resonance, are left out, since they are creep
    and loops and not mechanics: the gain at rest is then the one that a loop meets.  So are those that ring above all
    that was excited, which are noise.  Two states more take the part that follows within a sample of the thinned
    record: a delay of one sample at `rate`, and a lag.

    Parameters
    ----------
    model : InnovationModel
        Of thinned records, of one output.
    drives : sequence of arrays, each of shape (N, 1), V
        At `rate`, as deviations from the operating point.
    responses : sequence of arrays, each of shape (N, 1), m
    rate : float, samples/s
    """
    low, top = SLOWEST_MODE * model.rate, BEYOND * model.rate
    slow, outlet = _modal(
        model, rate / model.rate, lambda frequency, damping: damping <= RINGING and low <= frequency <= top
    )
    transition = block_diag(slow, [[0.0]], [[np.exp(-2 * np.pi * LAG * model.rate / rate)]])
    size = np.std(np.concatenate(responses))
    return _driven(model, (transition, np.hstack([outlet, [[size, size]]])), drives, responses, rate)


def _driven(
    model: InnovationModel,
    modes: tuple[np.ndarray, np.ndarray],
    drives: Sequence[np.ndarray],
    responses: Sequence[np.ndarray],
    rate: float,
    kept: np.ndarray | None = None,
) -> InnovationModel:
    """Fit B, and K, to records; A and C are given, and so is which states are kept when B is known (None: all)."""
    size_in = np.std(np.concatenate(drives), axis=0)
    size_out = np.std(np.concatenate(responses), axis=0)
    low, high = [each / size_in for each in drives], [each / size_out for each in responses]
    transition, outlet = modes[0], modes[1] / size_out[:, np.newaxis]
    fitted = fit_response(transition, outlet, low, high, Terms(direct=False, constant=False))
    a, b, c, d = (part.T.copy() for part in (transition, fitted.inlet, outlet, fitted.direct))
    missed = []
    for drive, response, state in zip(low, high, fitted.states, strict=True):
        free = np.empty_like(response)
        model_kernel.free_run(a, b, c, d, np.ascontiguousarray(drive), state.copy(), free)
        missed.append(response - free)
    every = np.ones(len(transition), bool) if kept is None else kept
    transition, outlet, inlet = transition[np.ix_(every, every)], outlet[:, every], fitted.inlet[every]
    everything = np.concatenate(missed)
    start = Gain(np.zeros((len(transition), model.outputs)), everything.T @ everything / len(everything), False)
    gain = refine_gain(transition, outlet, start, missed)
    return replace(
        model,
        A=transition,
        B=inlet / size_in,
        C=size_out[:, np.newaxis] * outlet,
        D=np.zeros_like(model.D),
        K=gain.matrix / size_out,
        rate=rate,
        innovation=size_out[:, np.newaxis] * gain.innovation * size_out,
    )


def _poles(blocks: np.ndarray) -> np.ndarray:
    """Return the pole that each state of a matrix from `_modal` belongs to: shape (n,), 1."""
    own = np.diag(blocks)
    poles: np.ndarray = own + 1j * (np.abs(blocks).sum(axis=1) - np.abs(own))
    return poles


def _modal(
    model: InnovationModel, factor: float, kept: Callable[[float, float], bool] = lambda *_: True
) -> tuple[np.ndarray, np.ndarray]:
    """Return A, block by block for each mode, at a rate `factor` times as high, and C in those coordinates.

    Only poles whose natural frequency, Hz, and damping ratio are `kept`.
    """
    poles, shapes = np.linalg.eig(model.A)
    blocks, columns = [np.zeros((0, 0))], [np.zeros((model.outputs, 0))]
    frequencies, dampings = frequency_and_damping(poles.astype(complex), model.rate)
    for pole, shape, frequency, damping in zip(poles, shapes.T, frequencies, dampings, strict=True):
        if pole.imag < 0 or not kept(frequency, 1.0 if pole.imag == 0 else damping):
            continue
        size = np.clip(abs(pole), FASTEST, 1 - SLOWEST) ** (1 / factor)
        seen = model.C @ shape
        seen = seen / max(float(np.linalg.norm(seen)), np.finfo(float).tiny)  # states in the outputs' unit
        if pole.imag == 0:
            blocks.append(np.array([[size]]))
            columns.append(seen.real[:, np.newaxis])
        else:
            turn = np.angle(pole) / factor
            c, s = size * np.cos(turn), size * np.sin(turn)
            blocks.append(np.array([[c, s], [-s, c]]))
            columns.append(np.stack([seen.real, seen.imag], axis=1))
    return block_diag(*blocks), np.hstack(columns)
