"""An innovation-form model to and from the state spaces of python-control and scipy.signal.

Those know inputs and outputs only: the Kalman gain and the innovations' covariance are left behind on the way out, and
given anew on the way in.  python-control is optional (`pip install vibrostage[control]`).
"""

from typing import Any

import numpy as np

from calibration.state_space.model import InnovationModel


def control_package() -> Any:
    """Import python-control.

    Raises
    ------
    ImportError : it is not installed; it says how to install it.
    """
    try:
        import control
    except ImportError as fault:
        raise ImportError(f"python-control is not there ({fault}): pip install 'vibrostage[control]'") from None
    return control


def to_control(model: InnovationModel) -> Any:
    """Return a `control.StateSpace` from inputs to outputs, with the signals' names.

    Of a model without inputs it is from innovations to outputs, (A, K, C, I).

    Raises
    ------
    ImportError : python-control is not installed.
    """
    names = model.input_names or tuple(f"e[{name}]" for name in model.output_names)
    return control_package().StateSpace(*_matrices(model), 1 / model.rate, inputs=names, outputs=model.output_names)


def from_control(system: Any, gain: np.ndarray | None = None, innovation: np.ndarray | None = None) -> InnovationModel:
    """Make a model of a discrete `control.StateSpace`.

    Parameters
    ----------
    system : control.StateSpace
    gain : array, shape (n, p), 1 per the outputs' units, optional
        Kalman gain; zero where not given.
    innovation : array, shape (p, p), products of the outputs' units, optional
        Covariance of the innovations; the identity where not given.

    Raises
    ------
    ValueError : continuous, or without a sample period.
    """
    rate = _rate(system.dt)
    names = tuple(system.input_labels), tuple(system.output_labels)
    return _model(system, rate, gain, innovation, names)


def to_scipy(model: InnovationModel) -> Any:
    """Return a discrete `scipy.signal.StateSpace` from inputs to outputs.

    Of a model without inputs it is from innovations to outputs, (A, K, C, I).
    """
    from scipy.signal import StateSpace

    return StateSpace(*_matrices(model), dt=1 / model.rate)


def from_scipy(system: Any, gain: np.ndarray | None = None, innovation: np.ndarray | None = None) -> InnovationModel:
    """Make a model of a `scipy.signal.dlti`: a discrete state space, transfer function or poles and zeros.

    Parameters
    ----------
    system : scipy.signal.dlti
    gain : array, shape (n, p), 1 per the outputs' units, optional
        Kalman gain; zero where not given.
    innovation : array, shape (p, p), products of the outputs' units, optional
        Covariance of the innovations; the identity where not given.

    Raises
    ------
    ValueError : continuous, or without a sample period.
    """
    rate = _rate(system.dt)
    return _model(system.to_ss(), rate, gain, innovation, ((), ()))


def _matrices(model: InnovationModel) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    if not model.inputs:
        return model.A, model.K, model.C, np.eye(model.outputs)
    return model.A, model.B, model.C, model.D


def _model(
    system: Any,
    rate: float,
    gain: np.ndarray | None,
    innovation: np.ndarray | None,
    names: tuple[tuple[str, ...], tuple[str, ...]],
) -> InnovationModel:
    outputs, order = np.shape(system.C)
    gain = np.zeros((order, outputs)) if gain is None else gain
    innovation = np.eye(outputs) if innovation is None else innovation
    return InnovationModel(system.A, system.B, system.C, system.D, gain, rate, innovation, *names)


def _rate(period: float | bool | None) -> float:
    if period is None or isinstance(period, bool) or not period > 0:
        raise ValueError(f"the system's sample period is {period}, must be > 0 s")
    return 1.0 / period
