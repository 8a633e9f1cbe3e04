"""What a recording over the loopback cable says of the measuring chain: the cable itself, the clocks, distortion."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.signal.windows import blackmanharris

from vibractl import alignment

TONES = (66.0, 88.0)
"""Hz.  Their products lie at multiples of 22 Hz, to the fifth order 2 Hz or more from harmonics of 50 and 60 Hz."""
ORDER = 5
PRODUCTS_FROM = 15.0
"""Hz."""
_CHIRPS = 16
"""In each stretch whose delay is measured: enough of the random signs to tell it from its neighbours."""
_REACH = 2048
"""Samples by which the delay of a stretch may differ from that of the whole."""
_LOBE = 4
"""Bins of a Blackman-Harris window's main lobe, to each side."""


@dataclass(frozen=True)
class Cable:
    """What came back over the loopback cable.

    Parameters
    ----------
    delay : float, samples; NaN when nothing came
    quality : float, 1
        As `alignment.Delay`, of the better sign.
    gain : float, 1
        Recorded over emitted; negative when inverted.
    """

    delay: float
    quality: float
    gain: float


def cable(train: np.ndarray, recorded: np.ndarray, rate: float) -> Cable:
    """Look for a train of chirps in a recording, upright or inverted.

    Parameters
    ----------
    train : array, shape (samples,), full scale
    recorded : array, shape (more samples,), full scale
    rate : float, samples/s

    Returns
    -------
    Cable
    """
    found = [alignment.delay(train, sign * recorded, rate, alignment.LOOPBACK_BAND) for sign in (1.0, -1.0)]
    inverted = found[1].quality > found[0].quality
    best = found[inverted]
    if not np.isfinite(best.samples):
        return Cable(best.samples, 0.0, 0.0)
    start = round(best.samples)
    heard = recorded[start : start + len(train)].astype(float)
    size = float(np.sqrt(np.sum(heard**2) / np.sum(train**2)))
    return Cable(best.samples, best.quality, -size if inverted else size)


@dataclass(frozen=True)
class Clock:
    """How the recording's clock runs against that of the output.

    Parameters
    ----------
    time : array, shape (stretches,), s
    delay : array, shape (stretches,), samples
        Of each stretch, less that of the first.
    deviation : float, 1
        Slope of a line through them: 1e-6 is 1 ppm.
    slip : float, samples
        Largest step between two stretches beyond that slope.
    quality : float, 1
        Of the worst stretch, as `alignment.Delay`.
    """

    time: np.ndarray
    delay: np.ndarray
    deviation: float
    slip: float
    quality: float


def clock(chirp: np.ndarray, count: int, recorded: np.ndarray, delay: float, rate: float) -> Clock:
    """Follow the delay of a train of chirps over a long recording.

    Parameters
    ----------
    chirp : array, shape (length,), full scale
    count : int, chirps of the train that was emitted from the recording's first sample on
    recorded : array, shape (samples,), full scale
    delay : float, samples, of the train as a whole
    rate : float, samples/s

    Returns
    -------
    Clock
    """
    train, step = alignment.timing_train(chirp, count), _CHIRPS * len(chirp)
    padded = np.concatenate((np.zeros(_REACH), recorded, np.zeros(_REACH)))
    starts = np.arange(0, count // _CHIRPS * step, step)
    found = []
    for start in starts:
        first = start + round(delay)
        window = padded[first : first + step + 2 * _REACH]
        found.append(alignment.delay(train[start : start + step], window, rate, alignment.LOOPBACK_BAND))
    delays = np.array([each.samples for each in found]) - found[0].samples
    quality = min(each.quality for each in found)
    time = (starts + step / 2) / rate
    if not np.isfinite(delays).all():
        return Clock(time, delays, float("nan"), float("nan"), quality)
    steps = np.diff(delays)
    usual = float(np.median(steps))
    slip = float(np.abs(steps - usual).max())
    slope = float(np.polyfit(time * rate, delays, 1)[0])
    return Clock(time, delays, slope, slip, quality)


def two_tones(rate: float, seconds: float, amplitude: float) -> np.ndarray:
    """Make two tones of `TONES` with soft ends, whose sum has the given peak.

    Parameters
    ----------
    rate : float, samples/s
    seconds : float, s
    amplitude : float, full scale

    Returns
    -------
    array, shape (samples,), full scale
    """
    time = np.arange(round(seconds * rate)) / rate
    edge = np.minimum(1.0, np.minimum(time, time[::-1]) / 0.1)
    tones = sum(np.sin(2 * np.pi * tone * time) for tone in TONES)
    return np.asarray(0.5 * amplitude * tones * np.sin(0.5 * np.pi * edge) ** 2)


def products(highest: float) -> np.ndarray:
    """Return where distortion of the two tones would lie, Hz, shape (products,), from `PRODUCTS_FROM` to `highest`."""
    orders = range(-ORDER, ORDER + 1)
    pairs = [(a, b) for a, b in product(orders, orders) if 2 <= abs(a) + abs(b) <= ORDER]
    lines = {abs(a * TONES[0] + b * TONES[1]) for a, b in pairs}
    return np.array(sorted(line for line in lines if PRODUCTS_FROM <= line <= highest))


def distortion(recorded: np.ndarray, rate: float, highest: float) -> tuple[float, float, float]:
    """Measure the distortion products of two tones, together, re the two tones.

    Parameters
    ----------
    recorded : array, shape (samples,), any unit; the tones last all through it
    rate : float, samples/s
    highest : float, Hz, of the products counted

    Returns
    -------
    level : float, dB
    noise : float, dB
        The same sum 5 Hz beside each product: what is no distortion.
    worst : float, Hz, of the largest product
    """
    window = blackmanharris(len(recorded), sym=False)
    power = np.abs(np.fft.rfft(window * (recorded - recorded.mean()))) ** 2
    spacing = rate / len(recorded)

    def at(frequency: float) -> float:
        middle = round(frequency / spacing)
        return float(power[max(middle - _LOBE, 0) : middle + _LOBE + 1].sum())

    tones = sum(at(tone) for tone in TONES) + np.finfo(float).tiny
    lines = products(highest)
    heard = np.array([at(line) for line in lines])
    beside = sum(at(line + 5.0) for line in lines)
    tiny = 1e-30
    level, noise = (10 * np.log10(total / tones + tiny) for total in (heard.sum(), beside))
    return float(level), float(noise), float(lines[np.argmax(heard)])
