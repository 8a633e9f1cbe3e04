"""The inner loop of the feed: an observer of the robot's velocity with a disturbance, and LQI feedback from it."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_discrete_are

from calibration.state_space.model import InnovationModel
from rigkit.record import Record
from stagectl.robot.milling.feed_record import MOST_STATES


@dataclass(frozen=True)
class VelocityWeights:
    """How the inner loop is weighed.

    Parameters
    ----------
    integral : float, s, > 0
        Time in which the integral weighs as much as the velocity itself.
    effort : float, 1, > 0
        Weight of the reference beside that of the velocity.
    doubt : float, 1, >= 0
        Rms of noise at the model's input over that of the innovations: how little the model is trusted.
    drift : float, 1, > 0
        Rms by which the disturbance changes in a sample, over that of the innovations.

    Raises
    ------
    ValueError : a weight out of its range, by name.
    """

    integral: float = 0.05
    effort: float = 1.0
    doubt: float = 0.3
    drift: float = 0.02

    def __post_init__(self) -> None:
        """Refuse what weighs nothing."""
        for name in ("integral", "effort", "drift"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} is {getattr(self, name)}, must be finite and > 0")
        if not 0.0 <= self.doubt < np.inf:
            raise ValueError(f"doubt is {self.doubt}, must be finite and >= 0")


@dataclass(frozen=True, eq=False)
class VelocityLoop:
    """xhat_k = (I - K C)(Phi xhat_{k-1} + Gamma u_{k-1}) + K v_k with a disturbance as last state, and u from it.

    u = l_r v_d - L xhat - L_i x_i, where x_i is the sum of h (v_d - v), u the velocity asked of the robot.

    Parameters
    ----------
    transition : array, shape (n + 1, n + 1), 1
        Phi, with the disturbance at the model's input.
    inlet : array, shape (n + 1,), s/m
        Gamma.
    outlet : array, shape (n + 1,), m/s
        C.
    gain : array, shape (n + 1,), s/m
        K.
    feedback : array, shape (n + 1,), m/s
        L; nothing of the disturbance, which the integral takes away.
    integral : float, 1/s
        L_i, < 0.
    forward : float, 1
        l_r.
    lag : float, s
        Time constant of the first-order loop in whose place it stands outside.

    Source
    ------
    Sörnmo 2015, eqs. (7.11) to (7.17).

    Departs
    -------
    l_r puts the zero of the closed loop on the pole of its integral, where the text has one, so that a change of v_d
    does not wake that.  For the zero-lag observer the identified noise of state and output are taken for independent.
    """

    transition: np.ndarray
    inlet: np.ndarray
    outlet: np.ndarray
    gain: np.ndarray
    feedback: np.ndarray
    integral: float
    forward: float
    lag: float

    @property
    def states(self) -> int:
        """How many states the observer has."""
        return len(self.inlet)

    def pack(self, loop: Record, least: float, most: float, rate: float) -> None:
        """Fill a record of `LOOP`, at rest, m/s from `least` to `most` and samples/s."""
        n = self.states
        loop.states = n
        loop.transition[:n, :n] = self.transition
        for name in ("inlet", "outlet", "gain", "feedback"):
            getattr(loop, name)[:n] = getattr(self, name)
        loop.integral, loop.forward, loop.least, loop.most, loop.period = (
            self.integral, self.forward, least, most, 1.0 / rate,
        )  # fmt: skip


def velocity_loop(model: InnovationModel, weights: VelocityWeights) -> VelocityLoop:
    """Design observer and feedback.

    Parameters
    ----------
    model : InnovationModel
        From the velocity asked of the robot (m/s) to its velocity (m/s).
    weights : VelocityWeights

    Raises
    ------
    ValueError : other inputs or outputs, a direct term, too many states, an unstable model, or one without a positive
        gain at rest.
    """
    _refuse_unfit(model)
    n, rate = model.order, model.rate
    transition = np.block([[model.A, model.B], [np.zeros((1, n)), np.ones((1, 1))]])
    outlet = np.append(model.C[0], 0.0)
    gain = _gain(model, weights, transition, outlet)
    step = np.block([[model.A, np.zeros((n, 1))], [-model.C / rate, np.ones((1, 1))]])
    drive = np.append(model.B[:, 0], 0.0)
    cost = np.outer(outlet, outlet)
    cost[n, n] = weights.integral**-2
    answer = solve_discrete_are(step, drive[:, None], cost, np.full((1, 1), weights.effort))
    both = drive @ answer @ step / (drive @ answer @ drive + weights.effort)
    closed = step - np.outer(drive, both)
    poles = np.linalg.eigvals(closed)
    slowest = poles[np.argmax(np.abs(poles))]
    forward = -both[n] / (rate * (1.0 - slowest.real)) if slowest.imag == 0.0 else 1.0
    lag = _lag(closed, np.append(forward * model.B[:, 0], 1.0 / rate), outlet, rate)
    feedback = np.append(both[:n], 0.0)
    return VelocityLoop(transition, drive, outlet, gain, feedback, float(both[n]), float(forward), lag)


def _gain(model: InnovationModel, weights: VelocityWeights, transition: np.ndarray, outlet: np.ndarray) -> np.ndarray:
    """Return the gain of the zero-lag observer with its disturbance, shape (n + 1,), s/m."""
    noise = np.diag(np.append(np.zeros(model.order), weights.drift**2))
    noise[:-1, :-1] = model.K @ model.K.T + weights.doubt**2 * model.B @ model.B.T
    covariance = solve_discrete_are(transition.T, outlet[:, None], noise, np.ones((1, 1)))
    gain: np.ndarray = covariance @ outlet / (outlet @ covariance @ outlet + 1.0)
    return gain


def _refuse_unfit(model: InnovationModel) -> None:
    if (model.inputs, model.outputs) != (1, 1):
        raise ValueError(f"the model has {model.inputs} inputs and {model.outputs} outputs, must have one of each")
    if not 1 <= model.order <= MOST_STATES:
        raise ValueError(f"the velocity model has {model.order} states, must be 1 to {MOST_STATES}")
    if model.D[0, 0] != 0.0:
        raise ValueError(f"the velocity model has a direct term of {model.D[0, 0]:g}, must be 0")
    fastest = float(np.abs(np.linalg.eigvals(model.A)).max())
    if not fastest < 1.0:
        raise ValueError(f"the velocity model has a pole of size {fastest:.4g}, must be < 1")
    gain = float((model.C @ np.linalg.solve(np.eye(model.order) - model.A, model.B))[0, 0])
    if not 0.5 <= gain <= 2.0:
        raise ValueError(f"the velocity model has the gain {gain:.4g} at rest, must be 0.5 to 2")


def _lag(loop: np.ndarray, drive: np.ndarray, outlet: np.ndarray, rate: float) -> float:
    """Return the time constant with the same area above the step response, s, at least a sample's."""
    away = np.linalg.solve(np.eye(len(loop)) - loop, drive)  # the resting state
    area = float(outlet @ np.linalg.solve(np.eye(len(loop)) - loop, away)) / rate
    pole = 1.0 - 1.0 / (rate * max(area, 1.5 / rate))
    return float(-1.0 / (rate * np.log(pole)))
