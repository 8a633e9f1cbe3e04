"""Sampled linear systems of one input and one output, joined and looked at over frequency."""

from dataclasses import dataclass

import numpy as np

from calibration.state_space.model import InnovationModel


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x[k+1] = A x[k] + B u[k], y[k] = C x[k] + D u[k].

    Parameters
    ----------
    A : array, shape (n, n), 1
    B : array, shape (n, 1), 1 per the input's unit
    C : array, shape (1, n), the output's unit
    D : array, shape (1, 1), the output's per the input's unit
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray

    def response(self, frequency: np.ndarray, rate: float) -> np.ndarray:
        """Return the frequency response, complex, shape (bins,), the output's per the input's unit.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        rate : float, samples/s
        """
        z = np.exp(2j * np.pi * frequency / rate)
        states = np.linalg.solve(z[:, None, None] * np.eye(len(self.A)) - self.A, self.B.astype(complex)[None])
        answer: np.ndarray = (self.C @ states + self.D)[:, 0, 0]
        return answer

    def delayed(self, samples: int) -> "StateSpace":
        """Return it with its output so many samples late."""
        system = self
        for _ in range(samples):
            n = len(system.A)
            system = StateSpace(
                np.block([[system.A, np.zeros((n, 1))], [system.C, np.zeros((1, 1))]]),
                np.vstack([system.B, system.D]),
                np.hstack([np.zeros((1, n)), np.ones((1, 1))]),
                np.zeros((1, 1)),
            )
        return system

    def then(self, after: "StateSpace") -> "StateSpace":
        """Return this system with `after` behind it."""
        n, m = len(self.A), len(after.A)
        return StateSpace(
            np.block([[self.A, np.zeros((n, m))], [after.B @ self.C, after.A]]),
            np.vstack([self.B, after.B @ self.D]),
            np.hstack([after.D @ self.C, after.C]),
            after.D @ self.D,
        )

    def closed(self) -> "StateSpace":
        """Return the loop of negative unit feedback around it."""
        part = 1.0 / (1.0 + self.D[0, 0])
        return StateSpace(self.A - part * self.B @ self.C, part * self.B, part * self.C, part * self.D)


def plant_of(model: InnovationModel) -> StateSpace:
    """Return what a model of one input and one output says of the plant; another model is a ValueError."""
    if (model.inputs, model.outputs) != (1, 1):
        raise ValueError(f"the model has {model.inputs} inputs and {model.outputs} outputs, must have one of each")
    return StateSpace(model.A, model.B, model.C, model.D)
