"""Mains, sensor noise and ships going by, as time passes: what is added to what the sensors say."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.pickup_kernel import add_mains, add_noise, add_ship

FIRST, LAST, STAGES = 1.0, 5_000.0, 6
"""Hz: where noise rises to low frequencies, 3 dB an octave, and first-order sections that make it."""
MEMORY = 30.0
"""s, of the mains' wandering frequency and of the sea's swell."""
SHIP_BAND = 0.7
"""1, quality factor of a ship's band of noise."""


@dataclass(frozen=True)
class Mains:
    """What is picked up from the mains.

    Parameters
    ----------
    frequency : float, Hz
    wander : float, Hz
        Standard deviation of the frequency, which so makes the phase wander.
    sines, cosines : arrays, shape (harmonics, sensors), m/s^2
        Of the first, second, ... harmonic.
    """

    frequency: float
    wander: float
    sines: np.ndarray
    cosines: np.ndarray


@dataclass(frozen=True)
class Noise:
    """Each sensor's own noise, and the sea's.

    Parameters
    ----------
    white : array, shape (sensors,), m/s^2
        Rms, over all frequencies to half the rate.
    rising : array, shape (sensors,), m/s^2
        Rms of white noise as strong as the 1/f noise is at 100 Hz.
    swell : float, 1
        Standard deviation of the logarithm of the latter's size.
    """

    white: np.ndarray
    rising: np.ndarray
    swell: float


@dataclass(frozen=True)
class Ships:
    """Ships that go by now and then: the closest approach is a bell in time.

    Parameters
    ----------
    per_minute : float, 1/minute
        How many, on average.
    level : float, m/s^2
        Rms of white noise as strong as one is at its middle, at the closest approach.
    seconds : float, s
        From the closest approach until it is half as loud.
    centre : float, Hz
        The middle of its band.
    blade, depth : float, Hz and 1
        How often and how deep the propeller modulates it.
    gains : array, shape (sensors,), 1
    """

    per_minute: float
    level: float
    seconds: float
    centre: float
    blade: float
    depth: float
    gains: np.ndarray


class Pickup:
    """All three together, block by block; the random numbers do not depend on the frames.

    Parameters
    ----------
    mains : Mains
    noise : Noise
    ships : Ships
    rate : float, samples/s
    block : int, samples
        Between two steps of what wanders.
    seed : int
    """

    def __init__(self, mains: Mains, noise: Noise, ships: Ships, rate: float, block: int, seed: int) -> None:
        self._mains, self._noise, self._ships = mains, noise, ships
        self._rate, self._block = rate, block
        slow, fast, events = np.random.SeedSequence(seed).spawn(3)
        self._slow, self._fast = np.random.default_rng(slow), np.random.default_rng(fast)
        self._events = np.random.default_rng(events)
        sensors = len(noise.white)
        self._white = np.zeros((block, sensors + 1))
        self._stages, self._memory = rising_stages(rate), np.zeros((sensors, STAGES))
        self._band, self._band_memory = ship_band(ships.centre, rate), np.zeros(2)
        self._blade = np.array([ships.depth, 0.0, 2 * np.pi * ships.blade / rate])
        self._phase, self._off, self._sea = 0.0, 0.0, 0.0
        self._swell, self._size = np.array([1.0, 0.0]), np.zeros(2)
        self._advance = 2 * np.pi * mains.frequency / rate
        self._done = 0
        self._closest, self._next = -1e9, self._wait(0.0)

    def begin_block(self) -> None:
        """Let all that wanders take a step."""
        seconds = self._block / self._rate
        keep = np.exp(-seconds / MEMORY)
        new, sea = np.sqrt(1 - keep * keep) * self._slow.standard_normal(2)
        self._off, self._sea = keep * self._off + new, keep * self._sea + sea
        self._advance = 2 * np.pi * (self._mains.frequency + self._mains.wander * self._off) / self._rate
        here = self._done * seconds
        self._done += 1
        self._swell[1] = (np.exp(self._noise.swell * self._sea) - self._swell[0]) / self._block
        self._size[0] = self._ship_at(here)
        self._size[1] = (self._ship_at(here + seconds) - self._size[0]) / self._block

    def add(self, heard: np.ndarray) -> None:
        """Add it to `heard`, shape (frames, sensors) m/s^2, in place; at most what is left of a block."""
        white = self._white[: len(heard)]
        self._fast.standard_normal(out=white)
        noise, mains = self._noise, self._mains
        add_noise(heard, white, noise.white, noise.rising, self._swell, self._stages, self._memory)
        if len(mains.sines):
            self._phase = add_mains(heard, self._phase, self._advance, mains.sines, mains.cosines)
        if self._ships.per_minute > 0:
            add_ship(heard, white, self._ships.gains, self._size, self._blade, self._band, self._band_memory)

    def _ship_at(self, seconds: float) -> float:
        """Return how loud ships are; the next one takes over when it is nearer in time."""
        if self._ships.per_minute <= 0:
            return 0.0
        while seconds > 0.5 * (self._closest + self._next):
            self._closest, self._next = self._next, self._wait(self._next)
        away = (seconds - self._closest) / self._ships.seconds
        return self._ships.level / (1 + away * away)

    def _wait(self, since: float) -> float:
        if self._ships.per_minute <= 0:
            return since
        return since + self._events.exponential(60 / self._ships.per_minute)


def rising_stages(rate: float) -> np.ndarray:
    """Return first-order sections b0, b1, a1, shape (stages, 3), that fall by 3 dB an octave, with gain 1 at 100 Hz.

    Parameters
    ----------
    rate : float, samples/s

    Source
    ------
    Oustaloup and others, IEEE Trans. Circuits and Systems I 47 (2000) 25: alternating poles and zeros for s^(-1/2).
    """
    last = min(LAST, 0.3 * rate)
    step = (last / FIRST) ** (1 / (2 * STAGES))
    poles = FIRST * step ** (2 * np.arange(STAGES) + 0.5)
    p, z = (np.exp(-2 * np.pi * corner / rate) for corner in (poles, poles * step))
    turn = np.exp(-2j * np.pi * 100.0 / rate)
    gain = np.abs((1 - z * turn) / (1 - p * turn))
    return np.stack([1 / gain, -z / gain, -p], axis=1)


def ship_band(centre: float, rate: float) -> np.ndarray:
    """Return b0, b1, b2, a1, a2 of a band-pass about `centre` Hz at `rate` samples/s, shape (5,), of gain 1 there."""
    warped = 1 / np.tan(np.pi * centre / rate)
    whole = warped**2 + warped / SHIP_BAND + 1
    through = warped / SHIP_BAND / whole
    return np.array([through, 0.0, -through, 2 * (1 - warped**2) / whole, (warped**2 - warped / SHIP_BAND + 1) / whole])
