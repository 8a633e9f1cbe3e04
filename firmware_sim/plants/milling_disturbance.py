"""What a milling cut does to stage and robot: forces on the tool, and how far the robot gives way."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.signal import lfilter

from firmware_sim.plants.options import choice, option, refuse_rate, refuse_wrong_options

DEFLECTIONS = {"x": 23.4e-6, "y": 138.4e-6, "z": 67.0e-6}
"""m, mean absolute deflection over the cut along the axis that is milled against [Sörnmo 2015, tab. 2.1]."""
FEED, SPINDLE, TEETH, TOOL = 7.5e-3, 28_000 / 60, 4, 8e-3
"""m/s, Hz, 1 and m [Sörnmo 2015, sec. 2.5 and, for the tool, 2.6]."""
MEAN_FORCES = {"x": (20.0, 10.0, 8.0), "y": (8.0, 20.0, 6.0), "z": (10.0, 6.0, 25.0)}
"""N on the plate, x y z, by what is milled: a quarter of the 100 N in steel [Sörnmo 2015, sec. 2.6]."""
FORCE_SPREAD = 0.1
"""Relative standard deviation from cut to cut, cut off at two of it."""
TOOTH_PASSING, TOOTH_OVERTONE, RUNOUT, CHIP_LOAD, CHATTER = 0.6, 0.2, 0.15, 0.1, 0.05
"""Of the mean force: amplitude at the teeth's frequency, at twice it, at the spindle's; rms below 2 Hz and of noise."""

RAMP_SHARES = {"x": 0.0, "y": 0.95, "z": 0.15}
"""Part of the slow deflection that grows along the cut: along y the workpiece was not square, the force does little."""
WANDER, WANDER_BAND = 0.25, (0.05, 2.0)
"""Rms of the rest that comes and goes, of its mean, and Hz: gear errors of the robot's joints, chip load."""
EIGENMODES = (((10.0, 18.0), 3e-6), ((18.0, 30.0), 1.5e-6))
"""Hz and m rms of the robot's two lowest eigenmodes, which the cut keeps ringing."""
EIGENMODE_DAMPING = (0.02, 0.05)
LINE_FREQUENCY = 95.0
"""Hz, the line of `line_amplitude`."""
SIDEWAYS = (0.05, 0.15)
"""Of the deflection along the milled axis, what the other two show."""


@dataclass(eq=False, kw_only=True)
class MillingOptions:
    """Which cut.

    Parameters
    ----------
    direction : str
        Axis that is milled against, as in Table 2.1: face milling in x, peripheral in y and z.
    seed : int
    start, seconds : float, s
        Until the tool meets the workpiece, and for how long it cuts.
    line_amplitude : float, m
        Of the deflection at 95 Hz.
    scale : float, 1
        Of deflection and force, for a stage of another travel.
    force : float, 1
        Of the force alone: steel takes a mean of 100 N, five times this along x and y, four times along z.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    direction: str = choice("x", "y", "z")
    seed: int = option(1, "", 0)
    start: float = option(1.0, "s", 0.0, 60.0)
    seconds: float = option(20.0, "s", 5.0, 120.0)
    line_amplitude: float = option(1.5e-6, "m", 0.0, 20e-6)
    scale: float = option(1.0, "1", 0.01, 10.0)
    force: float = option(1.0, "1", 0.0, 20.0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)


@dataclass(eq=False)
class MillingDisturbance(MillingOptions):
    """Peripheral or face milling of aluminium at 28 000 rpm, 7.5 mm/s, on a robot that holds the workpiece.

    Along `direction` the robot gives way slowly by what scales the whole to Table 2.1's uncompensated mean absolute
    error, rings at two eigenmodes between 10 and 30 Hz, and shakes at 95 Hz.  The force has its mean, the teeth's
    frequency and twice it, the spindle's, a slow part and noise; it comes and goes with the tool's diameter.  After
    the cut there is no force, and the robot stays where it is.

    It does not model: that stage and force answer each other (regenerative chatter), nor that the compensated cut
    differs from the uncompensated.

    Parameters
    ----------
    rate : float, samples/s, 1000 to 1e5

    Others: those of `MillingOptions`.

    Source
    ------
    Sörnmo 2015, sec. 2.5, tab. 2.1.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Draw the whole cut."""
        super().__post_init__()
        refuse_rate(self.rate, 1_000, 1e5, "the simulated cut")
        rng = np.random.default_rng(self.seed)
        before, cutting = round(self.start * self.rate), round(self.seconds * self.rate)
        self._force, self._base = np.zeros((2, before + cutting, 3))
        self._base[before:] = self.scale * _deflection(self, rng, cutting)
        self._force[before:] = self.scale * self.force * _force(self, rng, cutting)
        self._done = 0

    @property
    def cut(self) -> slice:
        """The samples of the cut."""
        return slice(round(self.start * self.rate), len(self._base))

    def run(self, force: np.ndarray, base: np.ndarray) -> None:
        """Go on for one frame.

        Parameters
        ----------
        force, base : arrays, shape (frames, 3), N and m
            Filled in place: on the plate, and of the robot; axes x y z.
        """
        left = max(min(len(force), len(self._base) - self._done), 0)
        force[:left] = self._force[self._done : self._done + left]
        base[:left] = self._base[self._done : self._done + left]
        force[left:] = 0.0
        base[left:] = self._base[-1]
        self._done += left


def _deflection(cut: MillingDisturbance, rng: np.random.Generator, samples: int) -> np.ndarray:
    """Return the robot's displacement over the cut, shape (samples, 3), m."""
    time = np.arange(samples) / cut.rate
    grip = _engagement(time, cut.seconds)
    ramp = RAMP_SHARES[cut.direction]
    slow = 2 * ramp * time / cut.seconds + (1 - ramp) * grip * (1 + WANDER * wander(time, rng))
    quick = np.zeros((samples, 3))
    milled = "xyz".index(cut.direction)
    shares = rng.uniform(*SIDEWAYS, 3)
    shares[milled] = 1.0
    for axis in range(3):
        for band, rms in EIGENMODES:
            quick[:, axis] += shares[axis] * rms * _ringing(samples, cut.rate, rng.uniform(*band), rng)
        phase = rng.uniform(0, 2 * np.pi)
        quick[:, axis] += shares[axis] * cut.line_amplitude * np.sin(2 * np.pi * LINE_FREQUENCY * time + phase)
    quick *= grip[:, None]
    wanted = DEFLECTIONS[cut.direction]

    def missed(size: float) -> float:
        return float(np.mean(np.abs(size * slow + quick[:, milled])) - wanted)

    size = brentq(missed, 0.0, 10 * wanted, xtol=1e-12)
    deflection: np.ndarray = size * slow[:, None] * shares + quick
    return deflection


def _force(cut: MillingDisturbance, rng: np.random.Generator, samples: int) -> np.ndarray:
    """Return the force on the plate over the cut, shape (samples, 3), N."""
    time = np.arange(samples) / cut.rate
    relative = np.ones((samples, 3)) + CHIP_LOAD * wander(time, rng)[:, None]
    lines = ((TEETH * SPINDLE, TOOTH_PASSING), (2 * TEETH * SPINDLE, TOOTH_OVERTONE), (SPINDLE, RUNOUT))
    for frequency, amplitude in lines:
        if frequency < cut.rate / 2:
            phase = rng.uniform(0, 2 * np.pi, 3)
            relative += amplitude * np.sin(2 * np.pi * frequency * time[:, None] + phase)
    relative += CHATTER * rng.standard_normal((samples, 3))
    mean = np.array(MEAN_FORCES[cut.direction]) * (1 + FORCE_SPREAD * np.clip(rng.standard_normal(3), -2, 2))
    force: np.ndarray = mean * relative * _engagement(time, cut.seconds)[:, None]
    return force


def _engagement(time: np.ndarray, seconds: float) -> np.ndarray:
    """Return how much of the tool cuts, 0 to 1: it enters and leaves at the feed, by its own diameter."""
    entry = TOOL / FEED
    edge = np.clip(np.minimum(time, seconds - time) / entry, 0.0, 1.0)
    engaged: np.ndarray = 0.5 * (1 - np.cos(np.pi * edge))
    return engaged


def wander(time: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return a slow random motion of unit variance: sines over `WANDER_BAND`, weaker as they are quicker.

    Parameters
    ----------
    time : array, shape (samples,), s
    rng : numpy.random.Generator

    Returns
    -------
    array, shape (samples,), 1
    """
    motion = np.zeros_like(time)
    frequencies = np.geomspace(*WANDER_BAND, 8) * rng.uniform(0.9, 1.1, 8)
    weight = frequencies**-0.5
    weight *= np.sqrt(2 / np.sum(weight**2))
    for frequency, amplitude in zip(frequencies, weight, strict=True):
        motion += amplitude * np.sin(2 * np.pi * frequency * time + rng.uniform(0, 2 * np.pi))
    return motion


def _ringing(samples: int, rate: float, frequency: float, rng: np.random.Generator) -> np.ndarray:
    """Return a mode's motion under white noise, of unit variance, shape (samples,)."""
    decay = np.exp(-2 * np.pi * frequency * rng.uniform(*EIGENMODE_DAMPING) / rate)
    poles = [1.0, -2 * decay * np.cos(2 * np.pi * frequency / rate), decay**2]
    motion = lfilter([1.0], poles, rng.standard_normal(samples))
    ringing: np.ndarray = motion / np.std(motion)
    return ringing
