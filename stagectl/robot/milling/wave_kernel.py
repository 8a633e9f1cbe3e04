"""The compiled kernel that follows periodic parts of the force: resonators, the ripple among them, and chatter."""

import math

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record
from stagectl.robot.milling.feed_record import BINS, LOW_BINS

SPARK = 2.0
"""Of the mean force: what a sample is apart from it by at most."""
TRACK = 0.05
"""Part of the way to the frequency seen that the ripple's goes in a sample."""
FADE = 0.04
"""Of the ripple's weight in a sample."""
USUAL = 0.004
"""Of the usual amplitude in a sample: 1 s at 250 samples/s."""
SWING, SWINGING = 0.35, 75
"""Amplitude below 30 Hz, over the mean force, that is an oscillation after so many samples."""
GROWN, LOUD, GROWING, WAIT, SETTLING = 3.0, 0.3, 10, 125, 75
"""By what an amplitude above 30 Hz has grown, and what it is of the mean force at least, for chatter after so many
samples; samples until it is judged again, and after the beginning of control."""
CALMED, QUIET, ANSWERS = 1.5, 1e-3, 3
"""Times the usual amplitude before it, which is taken for `QUIET` at least, beyond which chatter goes on, where it is
beyond `LOUD` as well; without that for `SETTLING` samples it has ended.  How often it is answered."""


@njit(cache=True, nogil=True)
def begin(waves: Record) -> None:
    """Have seen nothing."""
    for j in range(BINS):
        waves.cosines[j] = waves.sines[j] = 0.0
    waves.level = waves.omega = waves.ripple_cosine = waves.ripple_sine = waves.weight = 0.0
    waves.low = waves.high = waves.usual = 0.0
    waves.at = waves.samples = waves.swinging = waves.growing = waves.wait = 0
    waves.calm = 0.0
    waves.fading = waves.answers = waves.lasting = 0


@njit(cache=True, nogil=True)
def _resonate(waves: Record, rest: float) -> None:
    """Take a sample less its mean (N) into the resonators; find the highest bins, and the frequency of the ripple."""
    decay, low, high, at, turned = waves.decay, 0.0, 0.0, LOW_BINS, 0.0
    for j in range(BINS):
        real, imaginary = waves.cosines[j], waves.sines[j]
        a = flushed(decay * (waves.cosine[j] * real - waves.sine[j] * imaginary) + (1.0 - decay) * rest)
        b = flushed(decay * (waves.sine[j] * real + waves.cosine[j] * imaginary))
        waves.cosines[j], waves.sines[j] = a, b
        power = a * a + b * b
        if j < LOW_BINS:
            low = max(low, power)
        elif power > high:
            high, at = power, j
            turned = math.atan2(b * real - a * imaginary, a * real + b * imaginary)
    floor = max(waves.level, waves.floor)
    waves.low, waves.high = 2.0 * math.sqrt(low) / floor, 2.0 * math.sqrt(high) / floor
    centre = waves.turn * (at + 1)
    if at != waves.at and abs(waves.omega - centre) > waves.turn:
        waves.omega = centre
    waves.at = at
    if abs(turned - centre) < waves.turn:
        waves.omega += TRACK * (turned - waves.omega)


@njit(cache=True, nogil=True)
def observe(waves: Record, force: float) -> float:
    """Take in a force, N; return it without its ripple, where there is one worth taking out."""
    level = waves.level + waves.slow * (force - waves.level)
    floor = max(level, waves.floor)
    rest = min(max(force - level, -SPARK * floor), SPARK * floor)
    waves.level = level
    _resonate(waves, rest)
    before, beside, decay = waves.ripple_cosine, waves.ripple_sine, waves.decay
    cosine, sine = math.cos(waves.omega), math.sin(waves.omega)
    ripple = flushed(decay * (cosine * before - sine * beside) + (1.0 - decay) * rest)
    quarter = flushed(decay * (sine * before + cosine * beside))
    least = max(waves.share * floor, waves.noise) * (0.7 if waves.weight > 0.0 else 1.0)
    is_worth = 2.0 * math.hypot(ripple, quarter) > least and waves.samples > SETTLING
    weight = min(max(waves.weight + (FADE if is_worth else -FADE), 0.0), 1.0)
    waves.ripple_cosine, waves.ripple_sine, waves.weight = ripple, quarter, weight
    notched: float = force - 2.0 * weight * ripple
    return notched


@njit(cache=True, nogil=True)
def oscillates(waves: Record) -> bool:
    """Return whether a large oscillation below 30 Hz goes on (once a sample, while the force is controlled)."""
    samples = waves.samples + 1
    swinging = waves.swinging + 1 if samples > SETTLING and waves.low > SWING else 0
    waves.samples, waves.swinging = samples, swinging
    return swinging >= SWINGING


@njit(cache=True, nogil=True)
def _lasts(waves: Record) -> bool:
    """Return whether chatter that was seen goes on; it has ended when its peak has been as before for a while."""
    if waves.calm == 0.0:
        return False
    goes_on = waves.high > max(LOUD, CALMED * waves.calm)
    waves.fading = 0 if goes_on else waves.fading + 1
    if waves.fading > SETTLING:
        waves.calm, waves.answers, waves.lasting = 0.0, 0, 0
    elif waves.answers >= ANSWERS and waves.wait == 0:
        waves.lasting += 1
    return bool(goes_on)


@njit(cache=True, nogil=True)
def chatters(waves: Record) -> bool:
    """Return whether chatter is to be answered (once a sample, after `oscillates`).

    A peak above 30 Hz has grown beyond what is usual in this cut; or it goes on after the answer before.
    """
    if waves.samples <= SETTLING:
        waves.usual = waves.high
        return False
    waves.wait, high, lasts = max(waves.wait - 1, 0), waves.high, _lasts(waves)
    has_grown = high > GROWN * waves.usual and high > LOUD
    is_open = waves.wait == 0 and waves.answers < ANSWERS
    waves.growing = waves.growing + 1 if is_open and (has_grown or lasts) else 0
    waves.usual += USUAL * (high - waves.usual)
    if waves.growing < GROWING:
        return False
    waves.calm = waves.calm if waves.calm > 0.0 else max(waves.usual, QUIET)
    waves.answers, waves.growing, waves.wait = waves.answers + 1, 0, WAIT
    return True
