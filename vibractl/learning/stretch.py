"""Modes that move: all of G stretched along frequency, by a little more with every shot."""

import numpy as np

from vibractl.learning.disturbance import smoothed

SLOPE_REACH = 8
"""Lines to each side from which dG/df is read."""
REACH = 25
"""Lines to each side that are taken to be stretched alike."""
SHARE = 0.1
"""Of their information that counts: what disturbs one line disturbs its neighbours."""
FIRST, WALK = 1e-3, 1e-4
"""Parts of a frequency a shot, standard deviations: what is thought of the rate at first, how it changes in a shot."""
MISFIT = 3e-4
"""The same: by how much the rate of a line may differ from that of its neighbours."""


class Stretch:
    """Follows how fast the modes move, band by band.

    When all modes near a line move by a part delta of their frequency between two shots, G changes by -delta f dG/df:
    one number explains the change of response at many lines.  A filter that takes every line for itself sees a
    response that stays while the drive follows the mode, and takes it for a G that does nothing.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz, even
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
        The model's; its slope is carried along with the modes.
    """

    def __init__(self, frequency: np.ndarray, response: np.ndarray) -> None:
        weights = np.arange(-SLOPE_REACH, SLOPE_REACH + 1.0)
        weights /= (weights @ weights) * (frequency[1] - frequency[0])
        padded = np.pad(response, ((SLOPE_REACH, SLOPE_REACH), (0, 0), (0, 0)), mode="edge")
        windows = np.lib.stride_tricks.sliding_window_view(padded, len(weights), axis=0)
        self._frequency, self._gradient = frequency, windows @ weights
        self._moved = np.zeros(len(frequency))
        self._variance = np.full(len(frequency), FIRST**2)
        self.rate = np.zeros(len(frequency))

    @property
    def slope(self) -> np.ndarray:
        """Slope f dG/df where the modes are now, shape (lines, outputs, inputs), m/s^2 per V."""
        lines, outputs, inputs = self._gradient.shape
        flat, at = self._gradient.reshape(lines, -1), self._frequency / (1 + self._moved)
        there = np.stack([np.interp(at, self._frequency, column) for column in flat.T], axis=-1)
        slope: np.ndarray = self._frequency[:, None, None] * there.reshape(lines, outputs, inputs)
        return slope

    def observe(self, drive: np.ndarray, surprise: np.ndarray, variance: np.ndarray) -> np.ndarray:
        """Read the rate off a shot; return by how much G has changed since the one before.

        Parameters
        ----------
        drive : complex array, shape (lines, inputs), V s
            U of the shot before.
        surprise : complex array, shape (lines, outputs), m/s^2 s
            By how much the response changed beyond what G says of the change of drive.
        variance : array, shape (lines, outputs), (m/s^2 s)^2
            Of what else that may be, the uncertainty of G included.

        Returns
        -------
        complex array, shape (lines, outputs, inputs), m/s^2 per V
        """
        slope = self.slope
        effect = -(slope @ drive[..., None])[..., 0]
        power = np.abs(effect) ** 2
        doubt = variance + MISFIT**2 * smoothed(power, REACH)
        alike = SHARE * (2 * REACH + 1)
        information = alike * smoothed((power / doubt).sum(axis=1, keepdims=True), REACH)[:, 0]
        evidence = alike * smoothed(((effect.conj() * surprise).real / doubt).sum(axis=1, keepdims=True), REACH)[:, 0]
        before = self._variance + WALK**2
        self._variance = 1 / (1 / before + information)
        self.rate = self._variance * (self.rate / before + evidence)
        self._moved = self._moved + self.rate
        change: np.ndarray = -self.rate[:, None, None] * slope
        return change

    def coming(self) -> np.ndarray:
        """Return by how much G will change until the next shot, (lines, outputs, inputs), m/s^2 per V."""
        change: np.ndarray = -self.rate[:, None, None] * self.slope
        return change
