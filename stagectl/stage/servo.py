"""Servo states: the integral of the error (2.5), and oscillators that cancel disturbances of known frequencies."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from stagectl.config import Outer
from stagectl.stage.axis_record import MOST_SERVO_STATES


@dataclass(frozen=True, eq=False)
class Servo:
    """States driven by the control error: s[k+1] = A s[k] + B (r[k] - y[k]).  The first is the integral.

    Parameters
    ----------
    A : array, shape (s, s), 1
    B : array, shape (s, 1), s
        Everything integrates: states are in m s.
    weight : array, shape (s,), (1/s)^2
        What the square of a state costs, beside the square of the error (m^2).
    """

    A: np.ndarray
    B: np.ndarray
    weight: np.ndarray

    def tracking(self, feedback: np.ndarray, rate: float) -> np.ndarray:
        """Return the gain G by which states follow an input that is limited: shape (s, 1), s.

        While it is limited s[k+1] = (A + G L) s[k] + ...; G makes that settle as fast as the states' own weights say.

        Parameters
        ----------
        feedback : array, shape (1, s), 1/s
            L, from these states to the plant's input.
        rate : float, samples/s

        Raises
        ------
        ValueError : they are weighted so little that they would never settle.
        """
        acts = feedback[0] != 0.0  # what does not act need not settle
        size = np.where(acts, np.abs(feedback[0]), 1.0)
        row, one = np.where(acts, np.sign(feedback), 1.0), np.ones((1, 1))
        A = self.A * size[:, np.newaxis] / size  # of states times their size
        try:
            spread = solve_discrete_are(A.T, row.T, np.diag(self.weight / rate**2), one)
        except np.linalg.LinAlgError:
            slowest = np.sqrt(self.weight.min()) / (2 * np.pi)
            raise ValueError(
                f"the integral action's bandwidth is {slowest:.3g} Hz, must be higher at {rate:g} samples/s: it could "
                "not follow an input that is limited; calibrate again, or change [weights]"
            ) from None
        gain = A @ spread @ row.T / (row @ spread @ row.T + one)
        gain *= -(acts / size)[:, np.newaxis]
        return np.asarray(gain)


def servo(outer: Outer, bandwidth: float, rate: float) -> Servo:
    """Return the integral state and a pair of resonant states for each of `outer.resonances`.

    Parameters
    ----------
    outer : Outer
    bandwidth : float, Hz, > 0
        Of the integral action.
    rate : float, samples/s

    Raises
    ------
    ValueError : there are too many, or a resonance is not between 0 and half the rate.

    Source
    ------
    Sörnmo 2015, eq. (2.5); resonant states: Francis and Wonham, Automatica 12 (1976) 457, the internal model principle.
    """
    blocks, weights = [np.ones((1, 1))], [(2 * math.pi * bandwidth) ** 2]
    for frequency in outer.resonances:
        if not 0 < frequency < rate / 2:
            raise ValueError(f"outer.resonances has {frequency:g} Hz, must be > 0 and < {rate / 2:g}")
        angle = 2 * math.pi * frequency / rate
        radius = math.exp(-outer.resonance_damping * angle)
        turn = radius * np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        blocks.append(turn)
        weights += [(2 * math.pi * outer.resonance_width) ** 2] * 2
    states = len(weights)
    if states > MOST_SERVO_STATES:
        raise ValueError(f"outer.resonances has {len(outer.resonances)}, must be <= {(MOST_SERVO_STATES - 1) // 2}")
    drive = np.zeros((states, 1))
    drive[0, 0] = drive[1::2, 0] = 1.0 / rate
    return Servo(block_diag(*blocks), drive, np.array(weights))
