"""A discrete linear system with dead time, and the loop that holds one that would run away."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from firmware_sim.plants.linear_loop_kernel import run_loop


@dataclass(frozen=True)
class LinearSystem:
    """x' = A x + B u, y = C x + D u, each input late by whole samples.

    Parameters
    ----------
    dynamics : array, shape (states, states), 1
        A.
    inlet : array, shape (states, inputs), any unit
        B.
    outlet : array, shape (outputs, states), any unit
        C.
    direct : array, shape (outputs, inputs), any unit
        D.
    delay : int array, shape (inputs,), samples
    rate : float, samples/s
    """

    dynamics: np.ndarray
    inlet: np.ndarray
    outlet: np.ndarray
    direct: np.ndarray
    delay: np.ndarray
    rate: float

    @property
    def poles(self) -> np.ndarray:
        """Its poles, shape (states,), 1."""
        poles: np.ndarray = np.linalg.eigvals(self.dynamics)
        return poles

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Return its frequency response with the dead time, shape (bins, outputs, inputs), any unit.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        """
        turn = np.exp(2j * np.pi * frequency / self.rate)
        resolvent = turn[:, None, None] * np.eye(len(self.dynamics)) - self.dynamics
        late = turn[:, None] ** -self.delay
        whole: np.ndarray = (self.outlet @ np.linalg.solve(resolvent, self._broad) + self.direct) * late[:, None, :]
        return whole

    @property
    def _broad(self) -> np.ndarray:
        return self.inlet.astype(complex)[None]

    def with_delay_inside(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return A, B, C, D of the same system with the dead time among its states, shapes as in `LinearSystem`."""
        states, (outputs, inputs) = len(self.dynamics), self.direct.shape
        chains = [np.eye(late, k=-1) for late in self.delay]
        whole = block_diag(self.dynamics, *chains)
        inlet, outlet = np.zeros((len(whole), inputs)), np.zeros((outputs, len(whole)))
        outlet[:, :states] = self.outlet
        direct, place = np.zeros_like(self.direct), states
        for number, late in enumerate(self.delay):
            if late == 0:
                inlet[:states, number], direct[:, number] = self.inlet[:, number], self.direct[:, number]
                continue
            inlet[place, number] = 1.0
            whole[:states, place + late - 1] = self.inlet[:, number]
            outlet[:, place + late - 1] = self.direct[:, number]
            place += int(late)
        return whole, inlet, outlet, direct

    def run(
        self, added: np.ndarray, noise: np.ndarray, loop: tuple[np.ndarray, np.ndarray] | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return what it is given and what is measured, shapes (samples, inputs) and (samples, outputs).

        Parameters
        ----------
        added : array, shape (samples, inputs), any unit
            Its input, or what is added to the loop's.
        noise : array, shape (samples, outputs), any unit
            What is added to its output.
        loop : (array, array), optional
            The gains of a loop.
        """
        parts = self.with_delay_inside()
        states, (outputs, inputs) = len(parts[0]), self.direct.shape
        gains = loop or (np.zeros((inputs, states)), np.zeros((states, outputs)))
        given, measured = np.zeros((len(added), inputs)), np.zeros((len(added), outputs))
        a, b, c, d = map(np.ascontiguousarray, parts)
        run_loop((a, b, c, d), gains, added, noise, given, measured)
        return given, measured

    def loop(self, effort: float, noise: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the gains of a loop that holds it: quadratic-optimal feedback from a Kalman filter's estimate.

        Parameters
        ----------
        effort : float, > 0
            Weight of the input against the output.
        noise : float, > 0
            Of the output against the input, as the filter assumes it.

        Returns
        -------
        (array, array), shapes (inputs, states) and (states, outputs), any unit
            With the dead time among the states.

        Source
        ------
        Anderson and Moore, Optimal Control: Linear Quadratic Methods (1990).
        """
        a, b, c, _ = self.with_delay_inside()
        small = 1e-6 * np.eye(len(a))
        cost = solve_discrete_are(a, b, c.T @ c + small, effort * np.eye(b.shape[1]))
        feedback = np.linalg.solve(effort * np.eye(b.shape[1]) + b.T @ cost @ b, b.T @ cost @ a)
        spread = solve_discrete_are(a.T, c.T, b @ b.T + small, noise * np.eye(len(c)))
        observer = a @ spread @ c.T @ np.linalg.inv(c @ spread @ c.T + noise * np.eye(len(c)))
        return np.ascontiguousarray(feedback), np.ascontiguousarray(observer)
