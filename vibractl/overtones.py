"""Root and overtones of a response, followed along the phase of the reference."""

import numpy as np
from scipy.signal import hilbert
from scipy.signal.windows import blackmanharris

from vibractl.decibels import FAINT, decibels, rms
from vibractl.learning.laws import SIGNIFICANT

OVERTONES = 4
PERIODS = 5.0
"""Of the reference's lowest frequency, over which an overtone's amplitude and the root's phase are averaged.

From 4 on, the other orders lie outside the main lobe of a Blackman-Harris window: 92 dB down.
"""
FOLLOWED = 0.005
"""s between the values of amplitude and phase."""


class Overtones:
    """Follows responses along a reference.

    Parameters
    ----------
    reference : array, shape (frames, outputs), m/s^2
    rate : float, samples/s
    lowest : float, Hz
        Of the reference.
    """

    def __init__(self, reference: np.ndarray, rate: float, lowest: float) -> None:
        analytic: np.ndarray = hilbert(reference, axis=0)
        self._turn, self._hop = np.exp(-1j * np.angle(analytic)), max(1, round(FOLLOWED * rate))
        reach = min(round(PERIODS * rate / lowest), len(reference)) // (2 * self._hop) * self._hop
        window = blackmanharris(2 * reach + 1)
        self._window = window / window.sum()
        loud = np.abs(analytic) > SIGNIFICANT * np.abs(reference).max(axis=0)
        self._loud = loud.all(axis=1)[:: self._hop]
        self._root = self._averaged(reference * self._turn)

    def follow(self, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Follow root and overtones.

        Parameters
        ----------
        response : array, shape (frames, outputs), m/s^2

        Returns
        -------
        levels : array, shape (4, outputs), dB re the root
        phase : array, shape (times, outputs), rad
            Of the root, against the reference's.
        """
        parts, turned, loud = [], response, self._loud
        for _ in range(1, OVERTONES + 2):
            turned = turned * self._turn
            parts.append(self._averaged(turned))
        root = np.maximum(rms(np.abs(parts[0][loud])), FAINT)
        levels = np.stack([decibels(rms(np.abs(part[loud])) / root) for part in parts[1:]])
        return levels, np.angle(parts[0] * self._root.conj())[loud]

    def _averaged(self, signal: np.ndarray) -> np.ndarray:
        """Return the mean of a complex signal (frames, outputs) under the window, every `FOLLOWED` seconds."""
        reach, hop, spans = len(self._window) // 2, self._hop, len(self._loud)
        parts = len(self._window) // hop + 1
        weights = np.pad(self._window, (0, parts * hop - len(self._window))).reshape(parts, hop)
        turned = np.zeros((signal.shape[1], (spans + parts - 1) * hop), complex)
        turned[:, reach : reach + len(signal)] = signal.T
        pieces = turned.view(float).reshape(signal.shape[1], -1, hop, 2)
        sums = np.einsum("cshp,kh->pkcs", pieces, weights, optimize=True)  # by hop: BLAS does it
        level = np.sum([sums[:, part, :, part : part + spans] for part in range(parts)], axis=0)
        amplitude: np.ndarray = (level[0] + 1j * level[1]).T
        return amplitude
