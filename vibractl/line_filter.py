"""The transfer matrix as something that is learned on: a Kalman filter per line on the rows of G."""

import numpy as np

SURE = 1e-6
"""Of its size: no model is surer of G."""


class LineFilter:
    """Follows G line by line from how responses change with drives.

    The state of output o at a line is row o of G.  Between shots it walks at random by `walk` of its size; a change of
    drive dU and of response dY measures it, dY_o = dU^T g_o + v, at the line itself and at its neighbours, whose own G
    may differ by as much as is believed now.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    variance : array, shape (lines, outputs, inputs), (m/s^2 per V)^2
        Of the model's elements, E |G_hat - G|^2.
    walk : float, 1, > 0
        Standard deviation of the walk between two shots, re the row's RMS element.
    doubt : float, 1, >= 0
        Added to the model's own uncertainty at the start: G while a sweep is on its way is not G on average.
    neighbours : int, >= 0
        Lines to each side that measure G as well.
    """

    def __init__(self, response: np.ndarray, variance: np.ndarray, walk: float, doubt: float, neighbours: int) -> None:
        self.response = response.copy()
        self._walk, self._neighbours = walk, neighbours
        lines, outputs, inputs = response.shape
        self.covariance = np.zeros((lines, outputs, inputs, inputs), complex)
        self._inputs = np.arange(inputs)
        self._add(variance + ((doubt**2 + SURE**2) * self._size())[..., None])

    def forget(self, lines: np.ndarray, doubt: float) -> None:
        """Doubt the rows of some lines, bool (lines,), by `doubt` of their size."""
        self._add(np.where(lines[:, None], doubt**2 * self._size(), 0.0)[..., None])

    def observe(self, step: np.ndarray, change: np.ndarray, noise: np.ndarray) -> None:
        """Let a shot pass: walk, and correct by what it shows.

        Parameters
        ----------
        step : complex array, shape (lines, inputs), V s
            dU, by which the drive differs from that of an earlier shot.
        change : complex array, shape (lines, outputs), m/s^2 s
            dY, by which the response does.
        noise : array, shape (lines, outputs), (m/s^2 s)^2, > 0
            E |v|^2 of what else changes the response.
        """
        self._add((self._walk**2 * self._size())[..., None])
        reach = np.arange(-self._neighbours, self._neighbours + 1)
        near = np.clip(np.arange(len(step))[:, None] + reach, 0, len(step) - 1)
        steps, difference = step[near], self.response[near] - self.response[:, None]
        weight = 1.0 / (noise[near] + np.abs(np.einsum("lwi,lwoi->lwo", steps, difference)) ** 2)
        surprise = change[near] - np.einsum("lwi,loi->lwo", steps, self.response)
        information = np.einsum("lwi,lwo,lwj->loij", steps.conj(), weight, steps)
        self.covariance = np.linalg.inv(np.linalg.inv(self.covariance) + information)
        pull = np.einsum("lwi,lwo,lwo->loi", steps.conj(), weight, surprise)
        self.response = self.response + (self.covariance @ pull[..., None])[..., 0]

    def shift(self, change: np.ndarray) -> None:
        """Let G be another one by `change`, (lines, outputs, inputs), m/s^2 per V, and as certain as before."""
        self.response = self.response + change

    def spread(self, step: np.ndarray) -> np.ndarray:
        """Return E |dU^T (g_hat - g)|^2, (lines, outputs), (m/s^2 s)^2, of a step dU (lines, inputs), V s."""
        power: np.ndarray = np.einsum("li,loij,lj->lo", step, self.covariance, step.conj()).real
        return power

    @property
    def variance(self) -> np.ndarray:
        """E |G_hat - G|^2 of each element, shape (lines, outputs, inputs), (m/s^2 per V)^2."""
        diagonal: np.ndarray = self.covariance[..., self._inputs, self._inputs].real
        return diagonal

    def _size(self) -> np.ndarray:
        """Return the mean square element of each row, (lines, outputs)."""
        square: np.ndarray = (np.abs(self.response) ** 2).mean(axis=2)
        return square

    def _add(self, variance: np.ndarray) -> None:
        self.covariance[..., self._inputs, self._inputs] += variance
