"""What one emission gave: the recording, and whether anything may be learned from it."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibractl.config import Audio
from vibractl.flat_tops import flat_top

_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")

FULL_SCALE = 1.0 - 2.0**-14
"""A recorded sample from here on is clipped: the largest number of 16 bits is above."""
CLIPPED = "clipped"
"""How a reason begins that is of a signal that goes no further."""


@dataclass(frozen=True, eq=False)
class Capture:
    """One emission and what came back, aligned: response row n belongs to emitted row n.

    Parameters
    ----------
    emitted : float32 array, shape (samples, drives), V
        What left the guard.
    response : float32 array, shape (samples, responses), m/s^2
    far_field : float32 array, shape (samples, hydrophones), Pa
    loopback : float32 array, shape (samples,), full scale
        Silent when alignment is by marker.
    delay : float, samples
        Round trip by which responses came late; the whole part of the session's first is taken out of `response`,
        `far_field` and `loopback`.
    residual : float, samples
        Largest difference of the delay, anywhere in the emission, from the session's first.
    quality : float, 1
        Of the worst timing signal; see `alignment.Delay`.
    input_xruns, output_xruns : int
        Callbacks with a flag for lost input or output.
    late : int
        Callbacks that began more than two blocks after the one before.
    """

    emitted: np.ndarray
    response: np.ndarray
    far_field: np.ndarray
    loopback: np.ndarray
    delay: float
    residual: float
    quality: float
    input_xruns: int
    output_xruns: int
    late: int


@dataclass(frozen=True, eq=False)
class Discarded:
    """A recording that nothing may be learned from.

    Parameters
    ----------
    attempt : int, counted from 1
    reason : str
    capture : Capture
    """

    attempt: int
    reason: str
    capture: Capture


def spoiled(capture: Capture, audio: Audio) -> str:
    """Say what is wrong with the samples of a recording, whatever its alignment; nothing when they are fine.

    Parameters
    ----------
    capture : Capture
    audio : Audio
        What digital full scale means.

    Returns
    -------
    str
    """
    if capture.input_xruns or capture.output_xruns:
        return f"xruns: {capture.input_xruns} callbacks with lost input, {capture.output_xruns} with lost output"
    heard = capture.response / audio.input_full_scale, capture.far_field / audio.far_field_full_scale
    signals = np.column_stack((*heard, capture.loopback))
    names = [f"response {n + 1}" for n in range(capture.response.shape[1])]
    names += [f"far field {n + 1}" for n in range(capture.far_field.shape[1])]
    finite = np.isfinite(signals)
    if not finite.all():
        return f"a sample that is not finite, {_first(~finite, [*names, 'loopback'], audio.rate)}"
    clipped = np.abs(signals) >= FULL_SCALE
    if clipped.any():
        return f"{CLIPPED} at full scale, {_first(clipped, [*names, 'loopback'], audio.rate)}"
    units = ["m/s^2"] * capture.response.shape[1] + ["Pa"] * capture.far_field.shape[1]
    for name, unit, signal in zip(names, units, (*capture.response.T, *capture.far_field.T), strict=True):
        if (found := flat_top(signal)) is not None:
            value, count = found
            return f"{CLIPPED} below full scale, {name} does not pass {value:.3g} {unit} at {count} peaks"
    return ""


def unmoved(capture: Capture) -> str:
    """Name an accelerometer that stands still while something is emitted; nothing when all move."""
    dead = np.ptp(capture.response, axis=0) == 0
    if not (dead.any() and capture.emitted.any()):
        return ""
    which = int(np.argmax(dead))
    return f"a sensor that does not move: response {which + 1} is {capture.response[0, which]:g} m/s^2 throughout"


def _first(wrong: np.ndarray, names: list[str], rate: float) -> str:
    sample = int(np.argmax(wrong.any(axis=1)))
    name = names[int(np.argmax(wrong[sample]))]
    return f"{name} at {sample / rate:.4f} s, and {int(wrong.sum()) - 1} more"


def told(reasons: Sequence[str]) -> str:
    """Say why recordings were discarded: each reason once, whatever its numbers are, and how often it came.

    Parameters
    ----------
    reasons : sequence of str
        Of one recording each.

    Examples
    --------
    >>> told(["2 callbacks with lost input", "muted", "7 callbacks with lost input"])
    '3 recordings were discarded: 2 callbacks with lost input (2 times); muted'
    """
    alike: dict[str, list[str]] = {}
    for reason in reasons:
        alike.setdefault(_NUMBER.sub("#", reason), []).append(reason)
    said = [each[0] + f" ({len(each)} times)" * (len(each) > 1) for each in alike.values()]
    return f"{len(reasons)} recordings were discarded: {'; '.join(said)}"
