"""What a calibration's records say of the far field: the transfer from accelerometers to hydrophones, and its delay."""

import numpy as np

from calibration.local_polynomial import local_transfer
from calibration.multisine_estimate import coherence_of
from vibractl.config import RigConfig
from vibractl.far_field import FarField, turned
from vibractl.transfer_matrix import TransferMatrix

REACH, DEGREE = 8, 2
"""Lines to each side of a polynomial, and its degree: once its delay is out, T has no resonances."""
FLOOR = 0.003
"""Relative to |T|, Frobenius: of what no line shows alone, as a shell that flexes between accelerometer and water."""
FAINT = 0.8
"""Median coherence below which a hydrophone hears something else: T is half as large as its deviation."""


class FarFieldError(ValueError):
    """A far field that cannot be measured."""


def far_field_of(
    config: RigConfig,
    frequency: np.ndarray,
    response: np.ndarray,
    pressure: np.ndarray,
    wanted: np.ndarray,
    longest: tuple[str, float],
) -> FarField:
    """Estimate T of P = T Y from what one coil after the other makes accelerometers and hydrophones measure.

    Distortion is a part of both sides: what shells do is heard, whatever made them do it.

    Parameters
    ----------
    config : RigConfig
    frequency : array, shape (lines,), Hz
    response : complex array, shape (lines, accelerometers, coils), m/s^2 per V
    pressure : complex array, shape (lines, hydrophones, coils), Pa per V
    wanted : array, shape (wanted,), Hz
    longest : (str, float)
        Setting, and s, that the delay must not exceed: so much was played before each measurement.

    Raises
    ------
    FarFieldError : a hydrophone that is deaf, hears something else, or is too far away for these records.
    """
    channels = config.audio.far_field_channels
    for hydrophone, channel in enumerate(channels):
        if not np.any(pressure[:, hydrophone]):
            raise FarFieldError(f"hydrophone {hydrophone + 1}, input {channel}: silent, must hear the vibrator")
    delay = travel_time(frequency, response, pressure)
    found = local_transfer(frequency, response, pressure * turned(frequency, -delay)[..., None], wanted, REACH, DEGREE)
    floor = FLOOR**2 * (np.abs(found.value) ** 2).mean(axis=2, keepdims=True)
    variance = found.variance + floor
    coherence = coherence_of(found.value, variance)
    size = (np.abs(found.value) ** 2).sum(axis=2)
    known = np.median(size / (size + variance.sum(axis=2)), axis=0)
    for hydrophone, channel in enumerate(channels):
        named = f"hydrophone {hydrophone + 1}, input {channel}"
        if not known[hydrophone] >= FAINT:
            said = f"coherence with the accelerometers is {known[hydrophone]:.2f}"
            raise FarFieldError(f"{named}: {said}, must be >= {FAINT:g}")
        if not delay[hydrophone] <= longest[1]:
            raise FarFieldError(
                f"{named}: hears the vibrator {delay[hydrophone]:.3f} s late, must be <= {longest[0]}, {longest[1]:g} s"
            )
    return FarField(TransferMatrix(wanted, found.value, variance, coherence), delay)


def travel_time(frequency: np.ndarray, response: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Estimate how late each hydrophone hears: where the whitened cross-correlations with accelerometers peak.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz
    response : complex array, shape (lines, accelerometers, coils), m/s^2 per V
    pressure : complex array, shape (lines, hydrophones, coils), Pa per V

    Returns
    -------
    array, shape (hydrophones,), s
        To a quarter of a period of the whole band; up to half the reciprocal of the lines' spacing.

    Source
    ------
    Knapp and Carter 1976, "The generalized correlation method for estimation of time delay", IEEE Trans. ASSP 24(4).
    """
    step = 0.25 / (frequency[-1] - frequency[0])
    tried = np.arange(0.0, 0.5 / float(np.median(np.diff(frequency))), step)
    kernel = np.exp(2j * np.pi * np.outer(tried, frequency))
    cross = np.einsum("lhc,lac->lhac", pressure, response.conj())
    white = cross / np.maximum(np.abs(cross), np.finfo(float).tiny)
    score = np.abs(np.tensordot(kernel, white, axes=1)) ** 2
    late: np.ndarray = tried[score.sum(axis=(2, 3)).argmax(axis=0)]
    return late
