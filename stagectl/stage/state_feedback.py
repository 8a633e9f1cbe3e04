"""The outer loop's feedback: LQ on the model's states and the servo states, and what the reference adds."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from calibration.state_space.model import InnovationModel
from stagectl.stage.axis_record import MOST_STATES
from stagectl.stage.kalman import NoGain, modal_parts
from stagectl.stage.servo import Servo
from stagectl.stage.state_space import StateSpace, plant_of


@dataclass(frozen=True, eq=False)
class StateFeedback:
    """u = l_r r - L xhat - L_s s, with xhat from a Kalman filter on the model and s from the servo.

    Parameters
    ----------
    model : InnovationModel
        One input (m, the inner loop's reference), one output (m, the plate's position).
    gain : array, shape (n, 1), 1/m
        K of the filter.
    feedback : array, shape (1, n), m
        L.
    servo : Servo
    servo_feedback : array, shape (1, s), 1/s
        L_s.
    forward : float, m/m
        l_r.

    Source
    ------
    Sörnmo 2015, eqs. (2.3)-(2.5).

    Departs
    -------
    L x^r + l_r r is one number times r, as it is for every x^r that is linear in r; D of the model is not dropped.
    """

    model: InnovationModel
    gain: np.ndarray
    feedback: np.ndarray
    servo: Servo
    servo_feedback: np.ndarray
    forward: float = 0.0

    @property
    def observer(self) -> np.ndarray:
        """What the filter does to its own state, Phi - K C: shape (n, n), 1."""
        observer: np.ndarray = self.model.A - self.gain @ self.model.C
        return observer

    @property
    def drive(self) -> np.ndarray:
        """What the plant's input does to the filter, Gamma - K D: shape (n, 1), 1/m."""
        drive: np.ndarray = self.model.B - self.gain @ self.model.D
        return drive

    def system(self) -> StateSpace:
        """Return it as a system from the error (m) to the plant's input (m), without its limits and `forward`."""
        drive, states = self.drive, len(self.servo.A)
        return StateSpace(
            np.block(
                [
                    [self.observer - drive @ self.feedback, -drive @ self.servo_feedback],
                    [np.zeros((states, self.model.order)), self.servo.A],
                ]
            ),
            np.vstack([-self.gain, self.servo.B]),
            -np.hstack([self.feedback, self.servo_feedback]),
            np.zeros((1, 1)),
        )

    def reference_system(self) -> StateSpace:
        """Return it as a system from the reference (m) to the plant's input (m), while the position stays at zero."""
        error = self.system()
        start = np.vstack([self.drive * self.forward, self.servo.B])
        return StateSpace(error.A, start, error.C, np.full((1, 1), self.forward))

    def from_reference(self) -> tuple[StateSpace, StateSpace]:
        """Return the closed loop from reference to position without `forward`, and what a `forward` of one adds."""
        model, servo = self.model, self.servo
        n, m = model.order, len(servo.A)
        sums = -np.hstack([np.zeros((1, n)), self.feedback, self.servo_feedback])  # the input, without forward
        C = np.hstack([model.C, np.zeros((1, n + m))]) + model.D @ sums
        A = block_diag(model.A, self.observer, servo.A) + np.vstack([model.B, self.drive, np.zeros((m, 1))]) @ sums
        A += np.vstack([np.zeros((n, 1)), self.gain, -servo.B]) @ C
        B = np.vstack([model.B, self.drive, np.zeros((m, 1))])
        B = B + np.vstack([np.zeros((n, 1)), self.gain, -servo.B]) @ model.D
        return (
            StateSpace(A, np.vstack([np.zeros((2 * n, 1)), servo.B]), C, np.zeros((1, 1))),
            StateSpace(A, B, C, model.D),
        )


def linear_quadratic(
    model: InnovationModel, servo: Servo, drive: float, caution: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the gains that minimise the sum of y^2 + s' W s + (u / drive)^2 + caution^2 times each mode's own y^2.

    The last damps every mode for itself, rather than to let modes cancel each other in the output, which they do no
    longer when a natural frequency is not what the model says.

    Parameters
    ----------
    model : InnovationModel
        One input (m), one output (m).
    servo : Servo
    drive : float, m/m, > 0
        Input that may be spent on an error of one.
    caution : float, 1, >= 0

    Returns
    -------
    arrays, shapes (1, n), m, and (1, s), 1/s
        L and L_s.

    Raises
    ------
    ValueError : the model has other inputs or outputs, or too many states.
    NoGain : it has a zero at rest or at a resonance.
    """
    plant = plant_of(model)
    if not 0 < model.order <= MOST_STATES:
        raise ValueError(f"the model has {model.order} states, must be 1 to {MOST_STATES}")
    n = model.order
    A = np.block([[plant.A, np.zeros((n, len(servo.A)))], [-servo.B @ plant.C, servo.A]])
    B = np.vstack([plant.B, -servo.B @ plant.D])
    output = np.hstack([plant.C, np.zeros((1, len(servo.A)))])
    modes = caution * np.vstack([plant.C @ part for part in modal_parts(plant.A)])
    Q = output.T @ output + block_diag(modes.T @ modes, np.diag(servo.weight))
    R = drive**-2 + plant.D.T @ plant.D
    try:
        cost = solve_discrete_are(A, B, Q, R, s=output.T @ plant.D)
    except np.linalg.LinAlgError as fault:
        raise NoGain(
            f"there is no LQ gain for this model: {fault}; has it a gain at rest and at each resonance?"
        ) from None
    gains = np.linalg.solve(B.T @ cost @ B + R, B.T @ cost @ A + plant.D.T @ output)
    return gains[:, :n], gains[:, n:]


def ramp_feedforward(loop: StateFeedback) -> float:
    """Return the l_r that leaves no error when the reference moves at constant speed, m/m.

    Closed, the loop answers a reference with T = T_i + l_r T_f, where T_i(1) = 1 and T_f(1) = 0 for the integral's
    sake; l_r makes T'(1) = 0.

    Parameters
    ----------
    loop : StateFeedback
        Its own `forward` does not matter.
    """
    slopes = []
    for system in loop.from_reference():
        resting = np.linalg.solve(np.eye(len(system.A)) - system.A, system.B)
        slopes.append(float(-(system.C @ np.linalg.solve(np.eye(len(system.A)) - system.A, resting))[0, 0]))
    return -slopes[0] / slopes[1]
