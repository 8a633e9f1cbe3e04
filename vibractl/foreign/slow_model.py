"""What a model expects of a drive, at the lower rate at which recordings are looked at."""

import numpy as np

from vibractl.transfer_matrix import SIDE, TransferMatrix


class SlowModel:
    """A transfer matrix on the lines of stretches of one length; outside of its band and in its gaps it is zero.

    Parameters
    ----------
    matrix : TransferMatrix
        Of the whole rig.
    samples : int
        Of a stretch.
    rate : float, samples/s
    """

    def __init__(self, matrix: TransferMatrix, samples: int, rate: float) -> None:
        self._samples = samples
        frequency = np.fft.rfftfreq(samples, 1 / rate)
        self._inside = (frequency >= matrix.frequency[0]) & (frequency <= matrix.frequency[-1])
        for low, high, _ in matrix.gaps:
            self._inside &= (frequency <= low - SIDE) | (frequency >= high + SIDE)
        self._response = matrix.at(frequency[self._inside]).response

    def expected(self, drive: np.ndarray) -> np.ndarray:
        """Return the response to a drive.

        Parameters
        ----------
        drive : array, shape (samples, inputs), V
            Silent at both ends.

        Returns
        -------
        array, shape (samples, outputs), m/s^2
        """
        lines = np.fft.rfft(drive, axis=0)[self._inside]
        heard = np.zeros((len(self._inside), self._response.shape[1]), complex)
        heard[self._inside] = (self._response @ lines[..., None])[..., 0]
        return np.fft.irfft(heard, self._samples, axis=0)
