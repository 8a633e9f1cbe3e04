"""The compiled watch over an axis' error: half waves that go on without anything from outside that asks for them."""

from rigkit.compiled import njit
from rigkit.flush_kernel import flushed
from rigkit.record import Record

MOST = 40
"""Half waves that an oscillation has."""
SUSTAINED, KEEP = 0.8, 0.8
"""One of them is at least so large, re the envelope of those before; and what the envelope keeps of them.  An
oscillation that dies out with a damping of more than 1.5 % is none."""
ALIKE = 2.0
"""How many times longer or shorter than the one before."""
NOISES = 8.0
"""Range of what noise alone seems to call for, in standard deviations of one sensor."""


@njit(cache=True, nogil=True)
def is_oscillating(swing: Record, error: float, called: float) -> bool:
    """Take a sample in, m, and return whether the error oscillates by itself.

    Half waves between zero crossings of the error about its running mean, as Hägglund (1995) takes them; one counts
    where it is large, about as long and as large as those before, and larger than what `called`, the position that both
    manipulators together are called for by reference and disturbance, moves meanwhile.

    Parameters
    ----------
    swing : record of `SWING`
    error : float, m
        Of the relative position.
    called : float, m
        Reference less disturbance.

    Source
    ------
    T. Hägglund, A control-loop performance monitor, Control Engineering Practice 3 (1995) 1543.

    Departs
    -------
    Half waves are judged by their mean size, not their area, and by one another.
    """
    swing.mean = flushed(swing.pole * swing.mean + (1.0 - swing.pole) * error)
    value = error - swing.mean
    if value * swing.sign < 0.0:
        _end(swing)
        swing.before, swing.samples, swing.area = swing.samples, 0, 0.0
        swing.lowest = swing.highest = called
    if value != 0.0:
        swing.sign = 1.0 if value > 0.0 else -1.0
    swing.area += abs(value)
    swing.samples += 1
    swing.lowest, swing.highest = min(swing.lowest, called), max(swing.highest, called)
    return bool(swing.count >= MOST)


@njit(cache=True, nogil=True)
def begin(swing: Record) -> None:
    """Count from none again, and judge by what comes now."""
    swing.count = 0
    swing.envelope = 0.0


@njit(cache=True, nogil=True)
def _end(swing: Record) -> None:
    """Judge the half wave that is over."""
    size = swing.area / max(swing.samples, 1)
    moved = swing.highest - swing.lowest
    counts = size >= max(swing.least, SUSTAINED * swing.envelope) and moved <= size + NOISES * swing.noise
    counts = counts and swing.samples <= ALIKE * swing.before and swing.before <= ALIKE * swing.samples
    swing.envelope = flushed(KEEP * swing.envelope + (1.0 - KEEP) * size)
    swing.count = swing.count + 1 if counts else max(swing.count - 1, 0)
