"""Recordings at a lower rate: inputs and outputs through one low-pass, without the ends where it saw no signal."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ctlblocks.recording import Recording
from vibractl.spectrum import DECIMATOR_REACH, Decimator

LEAST = 100
"""Samples that must be left of each recording."""
PASSED = 0.75
"""Of half the lower rate, up to which the low-pass changes nothing (by 1e-4 at most): there the model holds."""


def thinned(signal: np.ndarray, factor: int) -> np.ndarray:
    """Keep every `factor`-th sample behind a linear-phase low-pass of 100 dB, its delay compensated.

    The first and the last `DECIMATOR_REACH` samples of the result are left out: they would depend on what was not
    recorded.  Inputs and outputs that go through it alike keep their transfer function.

    Parameters
    ----------
    signal : array, shape (N, width), any unit
    factor : int, >= 1

    Returns
    -------
    array, shape (ceil(N / factor) - 2 DECIMATOR_REACH, width), the same unit
        For a factor of 1 the signal.
    """
    thin = Decimator(factor).apply(signal)
    return thin[DECIMATOR_REACH:-DECIMATOR_REACH] if factor > 1 else thin


def shortest_stretch(factor: int, wanted: int) -> int:
    """Return how many samples a recording must have for `wanted` of them to be left at the lower rate.

    Parameters
    ----------
    factor : int, >= 1
    wanted : int, samples
    """
    return wanted if factor == 1 else factor * (max(wanted, LEAST) + 2 * DECIMATOR_REACH)


def thinned_recordings(recordings: Sequence[Recording], names: Sequence[str], factor: int) -> list[Recording]:
    """Lower the rate of recordings.

    Parameters
    ----------
    recordings : sequence of Recording
    names : sequence of str
        Of each, for errors.
    factor : int
        By which; 1 leaves them as they are.

    Raises
    ------
    ValueError : a factor below 1, or one that leaves too little of a recording.
    """
    if factor < 1:
        raise ValueError(f"--decimate is {factor}, must be a whole number >= 1")
    if factor == 1:
        return list(recordings)
    for each, name in zip(recordings, names, strict=True):
        samples = len(each.data)
        left = -(-samples // factor) - 2 * DECIMATOR_REACH
        if left < LEAST:
            most = (samples - 1) // (LEAST + 2 * DECIMATOR_REACH - 1)
            raise ValueError(
                f"--decimate is {factor}: {max(left, 0)} of the {samples} samples of {name} would be left, must be at "
                f"least {LEAST}: --decimate {most} at most"
                if most > 1
                else f"--decimate is {factor}: {name} has {samples} samples, too few to be decimated"
            )
    return [
        replace(
            each,
            rate=each.rate / factor,
            data=thinned(np.asarray(each.data, float), factor),
            provenance={**each.provenance, "decimated": f"{factor}", "recorded_rate": f"{each.rate:.9g}"},
        )
        for each in recordings
    ]


def thinning_note(rate: float, factor: int, recordings: int) -> str:
    """Say what was left out, and up to which frequency a model holds.

    Parameters
    ----------
    rate : float, samples/s
        The lower one.
    factor : int
    recordings : int
    """
    lost = DECIMATOR_REACH * factor
    each = "the recording" if recordings == 1 else f"each of the {recordings} recordings"
    return (
        f"decimated by {factor} to {rate:.9g} samples/s: {lost} samples at either end of {each} are left out, and the "
        f"model holds up to {PASSED * rate / 2:.4g} Hz"
    )
