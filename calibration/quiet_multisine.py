"""Multisines that stay inside the objective: a scout, and records shaped by what it has found."""

from dataclasses import replace

import numpy as np
from scipy.ndimage import maximum_filter1d

from calibration.emission_limit import EmissionLimit
from calibration.multisine import Design
from calibration.quiet_probes import LOW
from calibration.vibrator_multisine import QUIET_SPARE, design_of
from vibractl.config import RigConfig

FILLED = 0.4
"""Of what is allowed: every line of the records."""
PERIOD = 2.0
"""s, of probes and scout at most."""
SCOUT_SPARE = 2
"""Records of the scout beyond the number of coils."""
FEWEST = 11.0
"""Bins that a band has at least, beside those beyond its ends."""
NEAR = 2.0
"""Hz to each side within which the scout's largest response counts."""
NOTCH = 5.0
"""Times the median, that a line's drive is at most, however little is heard of it."""
DIFFERS = np.array([100.0, 150.0, 300.0, 500.0]), np.array([0.7, 0.4, 0.15, 0.1])
"""Hz, and by which part of |G| the response at a reference's level is another one, for friction gives way: measured on
vibrators of another structure."""


def scout_design(config: RigConfig) -> Design:
    """Design the records of probes and scout: all lines equally strong, and short."""
    settings, records = config.characterisation, len(config.audio.drive_channels) + SCOUT_SPARE
    low, high = settings.band
    period = min(settings.period, max(PERIOD, 1 / low, FEWEST / (high - low)))
    design, _ = design_of(_with(config, period=period), records, 0.0)
    return design


def shaped_design(
    config: RigConfig, frequency: np.ndarray, response: np.ndarray, limit: EmissionLimit
) -> tuple[Design, np.ndarray]:
    """Design records of which every line, by a model, takes the same part of what is allowed to it.

    Parameters
    ----------
    config : RigConfig
    frequency : array, shape (lines,), Hz, evenly spaced
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    limit : EmissionLimit

    Returns
    -------
    design : Design
    detection : int array
        Odd bins that are not excited.

    Source
    ------
    Sörnmo 2015, eq. (6.22), for all lines at once and without a preload: what that brings forth is over the limit.
    """
    flat, detection = design_of(_with(config), config.characterisation.records - QUIET_SPARE, 0.0)
    lines = flat.frequency
    size = 2 * round(NEAR / (frequency[1] - frequency[0])) + 1
    heard = maximum_filter1d(
        np.abs(response).max(axis=1), size, axis=0, mode="nearest"
    )  # by the output that hears most
    near = np.stack([np.interp(lines, frequency, column) for column in heard.T], axis=1)
    coils = near.shape[1]
    amplitude = FILLED * limit.allowed(lines, LOW)[:, None] / (coils * near)
    amplitude = np.minimum(amplitude, NOTCH * np.median(amplitude, axis=0))
    return replace(flat, amplitude=amplitude), detection


def doubted(frequency: np.ndarray, response: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Add to a variance how far a response to so little is from that at the level of a reference.

    Parameters
    ----------
    frequency : array, shape (lines,), Hz
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    variance : array, shape (lines, outputs, inputs), (m/s^2 per V)^2

    Returns
    -------
    array, shape (lines, outputs, inputs), (m/s^2 per V)^2
    """
    part = np.interp(frequency, *DIFFERS)[:, None, None]
    doubt: np.ndarray = variance + part**2 * (np.abs(response) ** 2).mean(axis=(1, 2), keepdims=True)
    return doubt


def _with(config: RigConfig, **settings: float) -> RigConfig:
    """Return a rig without a preload, and with other settings of its characterisation."""
    other = config.characterisation.model_copy(update={"operating": 0.0, **settings})
    return config.model_copy(update={"characterisation": other})
