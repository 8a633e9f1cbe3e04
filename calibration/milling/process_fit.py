"""G_M and G_K from one trial in material: how force arises from where the tool is, and deflection from force."""

from dataclasses import dataclass

import numpy as np

from calibration import subspace
from calibration.fit_measures import nrmse
from calibration.state_space.model import InnovationModel
from stagectl.robot.milling.learning import ProcessModel
from stagectl.robot.milling.milling_models import Process
from stagectl.robot.milling.zero_phase import filtered, low_pass

SLOWER = 5
"""Of the samples one in so many is used: what is learned is slower than a fifth of what is left."""
SMOOTH = 15.0
"""Hz, of the low-pass before that."""
HELD_BACK = 0.3
"""Of the trial, at its end."""
ORDERS = (1, 2, 3)
"""Of the models, that are tried."""
HORIZON = 20
"""Samples, of the subspace method: 0.4 s."""
SHORTEST = 8.0
"""s in material, of which less than the validation data is enough for models with these horizons."""
LINES = 200
"""Frequencies at which G_K G_M of the shorter record is kept."""


@dataclass(frozen=True, eq=False)
class ProcessFit:
    """What was fitted, for the file and the report.

    Parameters
    ----------
    process : Process
    time : array, shape (samples,), s
    position, force, deflection : arrays, shape (samples, 3), m, N and m
        As measured, about their means.
    force_model, deflection_model : arrays, shape (samples, 3), N and m
        What the models give.
    orders : (int, int)
        Of the models from speed to force, and from force to deflection.
    """

    process: Process
    time: np.ndarray
    position: np.ndarray
    force: np.ndarray
    deflection: np.ndarray
    force_model: np.ndarray
    deflection_model: np.ndarray
    orders: tuple[int, int]


def refuse_short(milled: np.ndarray, rate: float) -> None:
    """Refuse a path that is in the material too shortly for its models; before anything moves.

    Parameters
    ----------
    milled : array of bool, shape (N,)
        Which samples are in the material.
    rate : float, samples/s
    """
    seconds = float(np.ptp(np.flatnonzero(milled))) / rate
    if seconds < SHORTEST:
        raise ValueError(
            f"the path is in the material for {seconds:.3g} s, must be >= {SHORTEST:g} s to identify G_M and G_K: "
            "a larger pocket.size, or a smaller pocket.feed"
        )


def fit_process(
    seen: np.ndarray, deflection: np.ndarray, force: np.ndarray, milled: np.ndarray, rate: float
) -> ProcessFit:
    """Fit both.

    Parameters
    ----------
    seen : array, shape (N, 3), m
        y_n.
    deflection : array, shape (N, 3), m
        d = y_n - y_r - d_e.
    force : array, shape (N, 3), N
        On the tool, measured or estimated.
    milled : array of bool, shape (N,)
        Which samples are in the material.
    rate : float, samples/s

    Raises
    ------
    ValueError : a force that never changes.

    Source
    ------
    Sörnmo 2015, sec. 5.2.

    Departs
    -------
    Models are found by the subspace method instead of by prediction errors of transfer functions, which takes a hundred
    times as long for the same G_K (94 % on validation data); and force follows from the tool's speed, since where
    nothing moves nothing is cut: G_M has a zero at rest.
    """
    inside = np.flatnonzero(milled)
    part = slice(int(inside[0]), int(inside[-1]) + 1, SLOWER)
    y, d, f = (_slow(each, rate)[part] for each in (seen, deflection, force))
    y, d, f = (each - each.mean(axis=0) for each in (y, d, f))
    if not np.ptp(f, axis=0).max() > 0:
        raise ValueError("the force never changes: nothing was milled")
    slow, cut = rate / SLOWER, round(len(y) * (1 - HELD_BACK))
    v = np.diff(y, axis=0, prepend=y[:1]) * slow
    early_force, force_order, force_fresh = _best(v, f, slow, cut)
    early_compliance, order, fresh = _best(f, d, slow, cut)
    force_model, compliance = _identified(v, f, slow, force_order), _identified(f, d, slow, order)
    frequency = np.linspace(0.0, slow / 2, LINES)
    other = ProcessModel(_from_position(early_force), early_compliance).coupling(frequency)
    return ProcessFit(
        Process(ProcessModel(_from_position(force_model), compliance), force_fresh, fresh, frequency, other),
        np.arange(len(milled))[part] / rate,
        y,
        f,
        d,
        _free_run(force_model, v, f),
        _free_run(compliance, f, d),
        (force_order, order),
    )


def _best(drive: np.ndarray, response: np.ndarray, rate: float, cut: int) -> tuple[InnovationModel, int, np.ndarray]:
    """Return which model of the first samples fits the validation data best, its order, and its fits there (%)."""
    found = []
    for order in ORDERS:
        model = _identified(drive[:cut], response[:cut], rate, order)
        late, told = response[cut:], _free_run(model, drive[cut:], response[cut:])
        found.append((float(np.linalg.norm(late - told)), model, order, nrmse(late, told)))
    return min(found, key=lambda each: each[0])[1:]


def _identified(drive: np.ndarray, response: np.ndarray, rate: float, order: int) -> InnovationModel:
    return subspace.identify(drive, response, rate, order=order, horizon=HORIZON, detrend="none", delay=0).model


def _from_position(speed_model: InnovationModel) -> InnovationModel:
    """Return a model from speed (m/s) as one from position (m), whose last sample is three states more."""
    a, b, c, d = speed_model.A, speed_model.B, speed_model.C, speed_model.D
    rate, order = speed_model.rate, speed_model.order
    return InnovationModel(
        np.block([[a, -rate * b], [np.zeros((3, order + 3))]]),
        np.concatenate([rate * b, np.eye(3)]),
        np.concatenate([c, -rate * d], axis=1),
        rate * d,
        np.concatenate([speed_model.K, np.zeros((3, 3))]),
        rate,
        speed_model.innovation,
    )


def _free_run(model: InnovationModel, drive: np.ndarray, response: np.ndarray) -> np.ndarray:
    return model.simulate(drive, model.initial_state(drive, response))


def _slow(signal: np.ndarray, rate: float) -> np.ndarray:
    return filtered(signal, rate, lambda frequency: low_pass(frequency, SMOOTH)[:, None, None] * np.eye(3))
