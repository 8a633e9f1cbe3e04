"""What the recordings of a preloaded stepped sine say: the transfer matrix at every tone, with its variance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal.windows import tukey

from calibration.line_fit import LineEstimator, background
from calibration.refinement import memory
from calibration.settling import left_over, unsettled
from calibration.stepped_sine import Tones
from ctlblocks.recording import Recording
from vibractl.config import RigConfig
from vibractl.spectrum import Decimator
from vibractl.transfer_matrix import TransferMatrix

HEADROOM = 0.8
"""Of the decimated Nyquist frequency, what is used."""
BEYOND = 60.0
"""Hz past the band, from where harmonics of the preload still leak into it."""


def decimation(config: RigConfig) -> int:
    """Return by how much recordings are decimated before their tones are fitted."""
    nyquist = config.audio.rate / 2
    top = config.characterisation.band[1] + BEYOND
    return next((factor for factor in (16, 8, 4, 2) if top <= HEADROOM * nyquist / factor), 1)


@dataclass(frozen=True)
class Lines:
    """The transfer matrix at the tones of one batch, in any order.

    Parameters
    ----------
    frequency : array, shape (tones,), Hz
    response : complex array, shape (tones, outputs, inputs), m/s^2 per V
    variance : array, shape (tones, outputs, inputs), (m/s^2 per V)^2
    coherence : array, shape (tones, outputs, inputs), 1
    wait : array, shape (tones, inputs), s
        Before the tone was measured.
    before : array, shape (tones, inputs), Hz
        What the input carried before; 0 where it was at rest.
    """

    frequency: np.ndarray
    response: np.ndarray
    variance: np.ndarray
    coherence: np.ndarray
    wait: np.ndarray
    before: np.ndarray


class SweepEstimator:
    """Turns recorded batches into lines of the transfer matrix.

    Parameters
    ----------
    config : RigConfig
    """

    def __init__(self, config: RigConfig) -> None:
        self._settings = config.characterisation
        self._sides, self._factor = len(config.audio.drive_channels), decimation(config)
        self._rate = config.audio.rate / self._factor
        self._decimator = Decimator(self._factor)
        samples = round(self._settings.tone * config.audio.rate / self._factor)
        self._window = tukey(samples, self._settings.tukey, sym=False)
        self._accelerometers = len(config.audio.response_channels)
        self._silence = np.zeros((0, self._accelerometers + len(config.audio.far_field_channels)))

    def hear_silence(self, record: Recording) -> None:
        """Take what is heard without a drive into every variance from now on."""
        self._silence = self._signals(record)[:, self._sides :]

    def lines(self, batch: Tones, record: Recording) -> Lines:
        """Estimate G at every tone of a batch.

        Source
        ------
        Sörnmo 2015, eq. (6.3)-(6.6): G = Y U^-1 over one experiment a side.

        Departs
        -------
        Y and U are amplitudes of a windowed least-squares fit, see `LineEstimator`.
        """
        signals, window = self._signals(record), self._window
        frames, slots = len(window), np.argsort(batch.order, axis=1)
        starts = np.take_along_axis(batch.starts // self._factor, slots, axis=1)
        found = []
        for tone, frequency in enumerate(batch.frequency):
            others = self._harmonics(batch.preload_frequency[tone]) if batch.preload else np.zeros(0)
            estimator = LineEstimator(window, self._rate, float(frequency), others)
            fits = [estimator.fit(signals[start : start + frames]) for start in starts[:, tone]]
            amplitude = np.stack([fit.amplitude for fit in fits], axis=1)
            noise = np.stack([fit.variance[self._sides :] for fit in fits], axis=1)
            if len(self._silence) >= frames:
                noise = np.maximum(noise, background(self._silence, window, self._rate, float(frequency))[:, None])
            found.append(_matrix_of(amplitude[: self._sides], amplitude[self._sides :], noise))
        response, variance, coherence = (np.stack(part) for part in zip(*found, strict=True))
        wait = np.take_along_axis(batch.waits, slots, axis=1).T
        before = np.insert(batch.frequency[batch.order[:, :-1]], 0, 0.0, axis=1)
        return Lines(batch.frequency, response, variance, coherence, wait, np.take_along_axis(before, slots, axis=1).T)

    def joined(self, parts: Sequence[Lines], provenance: Mapping[str, str]) -> tuple[TransferMatrix, np.ndarray]:
        """Put the lines of all batches in one matrix, and what had not settled into their variance.

        Returns
        -------
        matrix : TransferMatrix
        heard : complex array, shape (bins, hydrophones, coils), Pa per V
        """
        frequency = np.concatenate([part.frequency for part in parts])
        order = np.argsort(frequency)
        frequency = frequency[order]
        response, variance, coherence, wait, last = (
            np.concatenate([getattr(part, name) for part in parts])[order]
            for name in ("response", "variance", "coherence", "wait", "before")
        )
        near = slice(None, self._accelerometers)
        heard, response = response[:, self._accelerometers :], response[:, near]
        before = np.where(last > 0, np.searchsorted(frequency, last), -1)
        share = left_over(memory(frequency, response), wait, self._window, self._rate)
        variance = variance[:, near] + unsettled(response, before, share)
        return TransferMatrix(frequency, response, variance, coherence[:, near], provenance), heard

    def _signals(self, record: Recording) -> np.ndarray:
        return self._decimator.apply(record.data.astype(float))

    def _harmonics(self, preload: float) -> np.ndarray:
        harmonics: np.ndarray = preload * np.arange(1, int((self._settings.band[1] + BEYOND) / preload) + 1)
        return harmonics


def _matrix_of(drive: np.ndarray, response: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Divide the responses by the drives, columns being experiments: (6.6), and what the noise makes of it."""
    inverse = np.linalg.inv(drive)
    matrix = response @ inverse
    power = np.abs(response) ** 2
    return matrix, noise @ np.abs(inverse) ** 2, power / (power + noise)
