"""The transfer matrix as something that is learned on: a Kalman filter per line on the rows of G."""

import numpy as np

from vibractl.learning.disturbance import smoothed
from vibractl.learning.variation import Variation, solved

SURE = 1e-6
"""Of its size: no model is surer of G."""
AT_ENDS, IN_SWINGS = 0.5, 0.1
"""Of G around a line: by how much it may be another one at the ends of a shot, and in each of its swings."""
WANDER = 0.1
"""Of that: how far it walks between two shots."""
AROUND = 25
"""Lines to each side that are around a line."""
BATCH = 128
"""Lines at a time, so that what is computed of them stays near the processor."""


class LineFilter:
    """Follows G line by line from how responses change with drives.

    The state of output o at a line is row o of G, and beside it, where G varies while a shot lasts, the rows of its
    variations.  Between shots G walks at random by `walk` of its size; a change of drive dU and of response dY measures
    it, dY_o = dU^T g_o + v, at the line itself and at its neighbours, whose own G may differ by as much as is believed
    now.

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
    variation : Variation, optional
        G is steady, and drives have no edges, without it.
    """

    def __init__(
        self,
        response: np.ndarray,
        variance: np.ndarray,
        walk: float,
        doubt: float,
        neighbours: int,
        variation: Variation | None = None,
    ) -> None:
        self._walk, self._neighbours = walk, neighbours
        self._variation = variation
        lines, outputs, self._inputs = response.shape
        parts, self._beside = len(variation.weights) if variation else 0, np.zeros((lines, outputs, 0))
        others = np.zeros((lines, outputs, parts * self._inputs), complex)
        self._rows = np.concatenate([response, others], axis=2)
        self.covariance = np.zeros((lines, outputs, *2 * self._rows.shape[2:]), complex)
        self._add(variance + ((doubt**2 + SURE**2) * self._size())[..., None])
        if parts:
            share = np.repeat([AT_ENDS] * 2 + [IN_SWINGS] * (parts - 2), self._inputs)
            self._beside = share**2 * smoothed(self._size(), AROUND)[..., None]
            np.einsum("...ii->...i", self.covariance)[..., self._inputs :] = self._beside

    @property
    def response(self) -> np.ndarray:
        """G on average while a shot lasts, (lines, outputs, inputs), m/s^2 per V."""
        return self._rows[..., : self._inputs]

    @property
    def couples(self) -> bool:
        """Whether a line of the drive is heard at others, too: by its edges, or as G varies while a shot lasts."""
        return self._variation is not None

    def emitted(self, drive: np.ndarray) -> np.ndarray:
        """Return what is emitted of lines (lines, inputs), V s: those of the drive with its edges."""
        lines: np.ndarray = self._parts(drive)[:, : self._inputs]
        return lines

    def explained(self, drive: np.ndarray) -> np.ndarray:
        """Return what a drive (lines, inputs), V s, is believed to make, (lines, outputs), m/s^2 s."""
        product: np.ndarray = (self._rows @ self._parts(drive)[..., None])[..., 0]
        return product

    def step_for(self, wanted: np.ndarray, inverse: np.ndarray, weight: np.ndarray) -> np.ndarray:
        """Return the change of drive that is believed to change the response as wanted, see `variation.solved`.

        Parameters
        ----------
        wanted : complex array, shape (lines, outputs), m/s^2 s
        inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        weight : array, shape (lines, outputs), 1
        """
        return solved(self._rows, self._variation, inverse, wanted, weight)

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
        np.einsum("...ii->...i", self.covariance)[..., self._inputs :] += WANDER**2 * self._beside
        reach = np.arange(-self._neighbours, self._neighbours + 1)
        near = np.clip(np.arange(len(step))[:, None] + reach, 0, len(step) - 1)
        believed, parts = self.response, self._parts(step)
        emitted = parts[:, : self._inputs]
        self._rows = self._rows.copy()
        for first in range(0, len(step), BATCH):
            lines = slice(first, first + BATCH)
            seen = near[lines]
            difference = believed[seen] - believed[lines, None]
            spoilt = noise[seen] + np.abs(np.einsum("lwi,lwoi->lwo", emitted[seen], difference)) ** 2
            self._correct(lines, parts[seen], change[seen], spoilt)

    def _correct(self, lines: slice, steps: np.ndarray, change: np.ndarray, noise: np.ndarray) -> None:
        """Correct some lines by what they and their neighbours show, (lines, neighbours, inputs or outputs)."""
        rows, covariance, steps = self._rows[lines], self.covariance[lines], steps[:, None]
        surprise = change.swapaxes(-1, -2) - (steps @ rows[..., None])[..., 0]
        shared = covariance @ steps.conj().swapaxes(-1, -2)
        expected = steps @ shared
        window = np.arange(steps.shape[2])
        expected[..., window, window] += noise.swapaxes(-1, -2)
        pull = shared @ np.linalg.inv(expected)
        covariance = covariance - pull @ shared.conj().swapaxes(-1, -2)
        self.covariance[lines] = 0.5 * (covariance + covariance.conj().swapaxes(-1, -2))
        self._rows[lines] = rows + (pull @ surprise[..., None])[..., 0]

    def shift(self, change: np.ndarray) -> None:
        """Let G be another one by `change`, (lines, outputs, inputs), m/s^2 per V, and as certain as before."""
        self._rows = self._rows.copy()
        self._rows[..., : self._inputs] += change

    def spread(self, step: np.ndarray) -> np.ndarray:
        """Return E |dU^T (g_hat - g)|^2, (lines, outputs), (m/s^2 s)^2, of a step dU (lines, inputs), V s."""
        parts = self._parts(step)[:, None, :, None]
        power: np.ndarray = (parts.swapaxes(-1, -2) @ self.covariance @ parts.conj())[..., 0, 0].real
        return power

    def around(self, step: np.ndarray) -> np.ndarray:
        """Return |dU|^2 times |G|^2 around each line, (lines, outputs), (m/s^2 s)^2: large in notches, too."""
        square = (np.abs(self.response) ** 2).reshape(len(step), -1)
        strength = np.abs(self.emitted(step)) ** 2
        power: np.ndarray = smoothed(square, AROUND).reshape(self.response.shape) @ strength[..., None]
        return power[..., 0]

    @property
    def variance(self) -> np.ndarray:
        """E |G_hat - G|^2 of each element, shape (lines, outputs, inputs), (m/s^2 per V)^2."""
        diagonal: np.ndarray = np.einsum("...ii->...i", self.covariance).real
        return diagonal[..., : self._inputs].copy()

    def _parts(self, drive: np.ndarray) -> np.ndarray:
        return self._variation.parts(drive) if self._variation else drive

    def _size(self) -> np.ndarray:
        """Return the mean square element of each row, (lines, outputs)."""
        square: np.ndarray = (np.abs(self.response) ** 2).mean(axis=2)
        return square

    def _add(self, variance: np.ndarray) -> None:
        diagonal = np.einsum("...ii->...i", self.covariance)  # a view
        diagonal[..., : self._inputs] += variance
