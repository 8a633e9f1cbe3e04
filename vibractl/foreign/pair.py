"""A drive and its response as other software recorded them: found to belong together, and cut to the shot."""

from dataclasses import dataclass

import numpy as np

from ctlblocks.recording import RecordingError
from vibractl.foreign.search import find
from vibractl.foreign.timing import timing
from vibractl.proof import SLIP

ALIKE = 1e-3
"""Of a drive's rms, by which one played may differ from the one that was to be played: what 10 bits would do."""
LIKE = 0.98
"""Least correlation of a recorded drive with the one that was to be played: a fifth of it may be noise and filters."""


@dataclass(frozen=True)
class Cut:
    """Where a shot lies in a recording.

    Parameters
    ----------
    first : int, samples
    fraction : float, samples
        By which it comes later than that.
    """

    first: int
    fraction: float


def find_shot(wanted: np.ndarray, played: np.ndarray, rate: float, name: str) -> Cut:
    """Find the drive that was to be played in what was recorded as played.

    Parameters
    ----------
    wanted : array, shape (samples, drives), V
    played : array, shape (samples, drives), V
    rate : float, samples/s
    name : str
        Of the file.

    Raises
    ------
    RecordingError : it is not in there, or was played by a clock that differs.
    """
    if len(played) < len(wanted):
        raise RecordingError(f"{name}: {len(played)} samples, must be at least {len(wanted)}, the shot's")
    size = float(np.linalg.norm(wanted))
    head = played[: len(wanted)]
    if float(np.linalg.norm(head - wanted)) <= ALIKE * size:
        return Cut(0, 0.0)
    place = find(wanted, [played])
    if not place.likeness >= LIKE:
        raise RecordingError(
            f"{name}: is not the drive that was to be played: correlation {place.likeness:.3f} where they are most "
            f"alike, must be >= {LIKE:g}"
        )
    found = timing(wanted, played, rate, float(place.first))
    slip = 1e-6 * abs(found.drift) * len(wanted)
    if not slip <= SLIP + 2e-6 * found.drift_error * len(wanted):
        raise RecordingError(
            f"{name}: was recorded by a clock that is {found.drift:.2f} ppm faster than the player's: {slip:.2f} "
            f"samples in a shot, must be <= {SLIP:g}; play and record by one device"
        )
    middle = found.delay + 0.5e-6 * found.drift * len(wanted)
    if not np.all(found.gain > 0):
        raise RecordingError(f"{name}: drive {int(np.argmin(found.gain)) + 1} is inverted")
    return Cut(round(middle), middle - round(middle))
