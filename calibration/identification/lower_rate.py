"""Whether recordings were made at a rate far above all that is in them, and which `--decimate` would do."""

from collections.abc import Sequence

import numpy as np
from scipy.signal import welch

from calibration.identification.thinning import shortest_stretch
from ctlblocks.recording import Recording

SHARE = 0.999
"""Of each channel's power, that is to lie below a frequency."""
TIMES = 5
"""The lower rate over that frequency, at least."""
WORTH = 4
"""Smallest factor that is worth a word."""
SEGMENT, SEGMENTS = 2**14, 32
"""Most samples of a segment of the spectrum, and the fewest segments: a sweep is in few of them at each frequency."""


def lower_rate_hint(recordings: Sequence[Recording]) -> str:
    """Return one line with a factor for `--decimate`; empty where the rate is near to what the recordings hold.

    Parameters
    ----------
    recordings : sequence of Recording
        Inputs and outputs, of one rate.
    """
    rate, shortest = recordings[0].rate, min(len(each.data) for each in recordings)
    highest = max(float(_holds_to(each).max()) for each in recordings)
    factor = int(rate // (TIMES * highest))
    while factor >= WORTH and shortest < shortest_stretch(factor, 0):
        factor -= 1
    if factor < WORTH:
        return ""
    return (
        f"{100 * SHARE:g} % of the power of every channel lies below {highest:.4g} Hz, at {rate:.9g} samples/s: "
        f"--decimate {factor} is {factor} times quicker, and tells slow modes better"
    )


def _holds_to(recording: Recording) -> np.ndarray:
    """Return the frequency below which nearly all of each channel's power lies, (channels,), Hz."""
    samples = max(min(SEGMENT, len(recording.data) // SEGMENTS), 2)
    frequency, power = welch(recording.data, recording.rate, nperseg=samples, axis=0)
    below = np.cumsum(power, axis=0) >= SHARE * power.sum(axis=0)
    found: np.ndarray = frequency[np.maximum(np.argmax(below, axis=0), 1)]
    return found
