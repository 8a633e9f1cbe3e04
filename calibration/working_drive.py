"""What a vibrator is driven by while weak lines measure it: a band of equal lines, or as its reference needs it."""

from dataclasses import dataclass

import numpy as np

from calibration.multisine import crest_phases, lines_to_time, low_crest
from vibractl.config import RigConfig
from vibractl.fft_plans import Plans
from vibractl.learning.law_of_run import learning_law
from vibractl.setup import reference_of
from vibractl.transfer_matrix import TransferMatrix

SPACING = 2.0
"""Hz between its lines, all odd: what even orders of distortion make of them falls on even lines alone."""
LEAST = 1e-4
"""Of its strongest line's power, from which on a line of the reference's drive counts."""


@dataclass(frozen=True, eq=False)
class WorkingDrive:
    """A preload, which every record repeats.

    Parameters
    ----------
    signal : array, shape (period, 1 or inputs), V
        One column where all coils have the same.
    bins : int array, shape (lines,), rising
        Where its lines are, in multiples of the inverse of its period.
    """

    signal: np.ndarray
    bins: np.ndarray

    @property
    def rms(self) -> float:
        """Root mean square over all coils, V."""
        return float(np.sqrt(np.mean(self.signal**2)))


def band_drive(config: RigConfig, rng: np.random.Generator) -> WorkingDrive:
    """Return equal lines over `characterisation.preload_band`, the same for all coils, of rms `operating`."""
    settings = config.characterisation
    period = round(settings.period * config.audio.rate)
    bins = _odd_bins(settings.preload_band, settings.period)
    one = low_crest(bins, period, settings.operating, rng) if settings.operating else np.zeros(period)
    return WorkingDrive(one[:, None], bins)


def reference_drive(config: RigConfig, matrix: TransferMatrix, rng: np.random.Generator) -> WorkingDrive:
    """Return a steady drive as strong, coil by coil and over frequency, as the one that a model gives the reference.

    Each line has the mean power that the reference's drive has around it while the reference lasts; coils are to each
    other in phase as there.

    Parameters
    ----------
    config : RigConfig
    matrix : TransferMatrix
        Of the whole rig, and all lines that are learned.
    rng : Generator
        Draws the phases it starts from.

    Raises
    ------
    ValueError : the reference cannot be made, or learning and the model do not fit it.
    """
    settings, rate = config.characterisation, float(config.audio.rate)
    reference, plans = reference_of(config), Plans(backend=config.spectrum.backend)
    law = learning_law(
        config.learning.model_copy(update={"start": "inverse"}),
        matrix,
        reference,
        rate,
        plans,
    )
    frequency = law.matrix.frequency
    seconds = np.sqrt(len(reference.signal) * len(reference.sounded)) / rate
    drive = 2.0 / seconds * (law.start @ law.spread.T)  # of steady tones, as strong as it is while the reference lasts
    power = np.sum(np.abs(drive) ** 2, axis=1)
    counts = frequency[power >= LEAST * power.max()]
    bins = _odd_bins((counts[0], counts[-1]), settings.period)
    step = bins[1] - bins[0] if len(bins) > 1 else 1
    nearest = np.clip(np.round((frequency * settings.period - bins[0]) / step), 0, len(bins) - 1).astype(int)
    squares = np.zeros((len(bins), drive.shape[1]))
    np.add.at(squares, nearest, np.abs(drive) ** 2)
    strongest = int(np.argmax(squares.sum(axis=0)))
    turned = np.zeros(squares.shape, complex)
    np.add.at(turned, nearest, drive * drive[:, strongest, None].conj())
    amplitude = np.sqrt(squares)
    phase = crest_phases(bins, amplitude[:, strongest] / amplitude[:, strongest].max(), rng)
    lines = amplitude * np.exp(1j * (phase[:, None] + np.angle(turned)))
    return WorkingDrive(lines_to_time(bins, lines, round(settings.period * rate)), bins)


def _odd_bins(band: tuple[float, float], period: float) -> np.ndarray:
    """Return odd bins, `SPACING` apart, that begin within a band of Hz; at least one."""
    step = max(2 * round(SPACING * period / 2), 2)
    first = int(np.ceil(band[0] * period)) | 1
    return np.arange(first, max(int(band[1] * period), first) + 1, step)
