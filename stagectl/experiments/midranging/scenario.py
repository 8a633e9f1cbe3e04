"""References for mid-ranging, and what happens to the pair meanwhile."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks.recording import Recording
from rigkit.foreign_record import read_signals

PERIOD, AMPLITUDE = 4.0, 2e-3
"""s and m of the square wave of both simulations: its steps saturate the inner control signal."""
SINE_PERIOD, SINE_AMPLITUDE, SLOPE = 20.0, 1e-3, 0.5e-3
"""s and m of the slow sine, m/s of the ramp."""
DISTURBANCE, DISTURBED_AT = 5e-3, 18.0
"""m and s [Sörnmo 2015, section 3.3]."""
GAINS = ((8.0, 1.5), (16.0, 0.6))
"""s and multiple of the first gain: half more, then 60 % less [Sörnmo 2015, section 3.3]."""
SECONDS = {"thesis-1": 28.0, "thesis-2": 24.0}
RADIUS, FEED, RAMP = 35e-3, 5e-3, 1.0
"""m of the toroid's path, m/s along it, and s in which that begins and ends [Sörnmo 2015, section 2.4]."""
TOROID = "toroid"
SCENARIOS = (*SECONDS, TOROID)
"""Those that need no file."""
FURTHEST = 10.0
"""m, of a reference in a file."""
HALF_STEP, STEPS = 4.5, 6
"""s of each step of Table 3.1, and how many there are, up and down in turn."""


@dataclass(frozen=True)
class Scenario:
    """What the relative position is to be, and what happens meanwhile.

    Parameters
    ----------
    name : str
    reference : array, shape (samples,), m
    options : mapping
        Keywords of the simulated pair; times count from the first sample of the reference.
    period : float, s
        Of the reference; 0 where it has none.
    """

    name: str
    reference: np.ndarray
    options: dict[str, Any] = field(default_factory=dict)
    period: float = 0.0

    @property
    def gains(self) -> tuple[tuple[float, float], ...]:
        """From when on, s, the micro manipulator's process gain is which multiple of the first one."""
        return tuple(self.options.get("gains", ()))


def scenario(name: str, rate: float) -> Scenario:
    """Return simulation 1 or 2 of the thesis, or the reference in a file.

    Parameters
    ----------
    name : str
        "thesis-1", "thesis-2", or the path of a CSV or WAV file with one channel, m.
    rate : float, samples/s

    Raises
    ------
    ValueError : there is no such scenario; the file has another rate or more than one channel.
    """
    if name in SECONDS:
        time = np.arange(round(SECONDS[name] * rate)) / rate
        wave = AMPLITUDE * np.where(time % PERIOD < PERIOD / 2, 1.0, -1.0)
        wave += SINE_AMPLITUDE * np.sin(2.0 * np.pi * time / SINE_PERIOD)
        if name == "thesis-1":
            options = {"disturbance": DISTURBANCE, "disturbed_at": DISTURBED_AT}
            return Scenario(name, wave + SLOPE * time, options, PERIOD)
        return Scenario(name, wave, {"gains": GAINS}, PERIOD)
    if Path(name).suffix.lower() not in (".csv", ".wav"):
        raise ValueError(f"scenario is {name!r}, must be table-3.1, {', '.join(SCENARIOS)}, or a CSV or WAV file")
    found = _wanted(Path(name), rate)
    if len(found.names) != 1:
        raise ValueError(f"{name}: channels are {', '.join(found.names)}, must be 1")
    return Scenario(Path(name).stem, found.data[:, 0].astype(np.float64))


def scenarios(name: str, rate: float) -> dict[str, Scenario]:
    """Return what each axis is to do, by its name; one without a name where there is one axis only.

    Parameters
    ----------
    name : str
        As of `scenario`, "toroid", or the path of a file with a channel an axis, m.
    rate : float, samples/s

    Raises
    ------
    ValueError : as of `scenario`.
    """
    if name == TOROID:
        return {axis: Scenario(TOROID, wanted) for axis, wanted in zip("yz", toroid(rate).T, strict=True)}
    if Path(name).suffix.lower() in (".csv", ".wav"):
        found = _wanted(Path(name), rate)
        if found.data.shape[1] > 1:
            return {
                axis: Scenario(Path(name).stem, found.select([axis]).data[:, 0].astype(float)) for axis in found.names
            }
    return {"": scenario(name, rate)}


def _wanted(file: Path, rate: float) -> Recording:
    """Read the reference in a file; ValueError where it is none, in m."""
    found = read_signals(file, rate)
    for channel, unit, samples in zip(found.names, found.units, found.data.T, strict=True):
        if unit not in ("m", "1"):  # "1": a file that names no unit
            raise ValueError(f"{file}: channel {channel} is in {unit}, must be in m")
        furthest = abs(samples).max(initial=0.0)
        if not furthest <= FURTHEST:
            raise ValueError(f"{file}: channel {channel} goes {furthest:g} m far, must stay within {FURTHEST:g} m")
    return found


def toroid(rate: float) -> np.ndarray:
    """Return the toroid's path once around, from rest to rest, shape (samples, 2), m; it begins at 0 along x."""
    seconds = 2.0 * np.pi * RADIUS / FEED + RAMP
    time = np.arange(round(seconds * rate) + 1) / rate
    rise = (0.5 - 0.5 * np.cos(np.pi * np.clip(each / RAMP, 0.0, 1.0)) for each in (time, seconds - time))
    way = np.cumsum(FEED * np.prod(list(rise), axis=0)) / rate
    angle = way / RADIUS
    return RADIUS * np.stack([np.sin(angle), 1.0 - np.cos(angle)], axis=1)


def steps(size: float, rate: float) -> np.ndarray:
    """Return steps from 0 to `size` (m) and back, as Table 3.1 has them, shape (samples,), m."""
    half = round(HALF_STEP * rate)
    return np.concatenate([np.full(half, size * (1 - number % 2)) for number in range(STEPS)])
