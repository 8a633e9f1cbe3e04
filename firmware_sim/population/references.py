"""What a drawn vibrator is asked for, and the drive that its linear response makes of that."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams

RATE, SECONDS, ROOM = 512, 5.0, 8.0
"""samples/s at which drives are worked out, s of a reference, and s until it begins again."""
TAPER = 0.04
"""1, of a reference at each end; the rig file's default."""
WEIGHT = 1e-3
"""1, of ||G||^2: how the inverse is bounded where G is near singular."""
STANDARD = (40.0, 90.0)
"""Hz, of the chirp that every vibrator is asked for."""
SLOWEST, FASTEST, WIDTH = 16.0, 95.0, (1.8, 2.5)
"""Hz, and last over first frequency, of the others."""
OTHERWISE = 24.0
"""Hz of a sine where the first resonance is out of reach."""


@dataclass(frozen=True)
class Wanted:
    """A reference.

    Parameters
    ----------
    first, last : float, Hz
        The same for a sine.
    """

    first: float
    last: float

    @property
    def text(self) -> str:
        """As a rig file has it."""
        if self.first == self.last:
            return f"sine:{self.first:g}:{SECONDS:g}"
        return f"chirp:{self.first:g}:{self.last:g}:{SECONDS:g}"

    @property
    def signal(self) -> np.ndarray:
        """Its samples, shape (RATE ROOM,), of amplitude 1; silence at the end."""
        count = round(RATE * SECONDS)
        time = np.arange(count) / RATE
        phase = self.first * time + (self.last - self.first) / (2 * SECONDS) * time**2
        edge = 0.5 - 0.5 * np.cos(np.pi * np.clip(time / (TAPER * SECONDS), 0, 1))
        whole = np.zeros(round(RATE * ROOM))
        whole[:count] = np.sin(2 * np.pi * phase) * edge * edge[::-1]
        return whole

    @property
    def line(self) -> float:
        """Its spectrum in its own band, m/s^2 s for an amplitude of 1 m/s^2."""
        return 0.5 * SECONDS if self.first == self.last else 0.5 * float(np.sqrt(SECONDS / (self.last - self.first)))


def draw_references(streams: Streams, resonance: float) -> tuple[Wanted, ...]:
    """Draw three references, the machine's own first: the standard chirp, another, and a sine at the first resonance.

    Parameters
    ----------
    streams : Streams
    resonance : float, Hz
    """
    rng = streams("chirp")
    low = round(float(log_uniform(rng, SLOWEST, 45.0)))
    high = min(round(low * float(rng.uniform(*WIDTH))), FASTEST)
    at = round(resonance / 0.2) * 0.2
    sine = round(at, 1) if at >= SLOWEST else OTHERWISE
    three = Wanted(*STANDARD), Wanted(low, high), Wanted(sine, sine)
    own = int(streams("reference").choice(3, p=[0.5, 0.3, 0.2]))
    return three[own], *(each for n, each in enumerate(three) if n != own)


@dataclass(frozen=True)
class Need:
    """What a reference needs of the amplifier, per m/s^2 of its amplitude.

    Parameters
    ----------
    peak, rms : float, V
        Of the coil that needs most; rms over the reference.
    slew : float, V/s
    """

    peak: float
    rms: float
    slew: float


Respond = Callable[[np.ndarray], np.ndarray]
"""A vibrator's linear G, (bins, sensors, coils) m/s^2 per V, at frequencies (bins,) Hz."""


def needed(respond: Respond, wanted: Wanted) -> Need:
    """Return what the linear response says that a reference needs.

    Parameters
    ----------
    respond : callable
        G at frequencies.
    wanted : Wanted
    """
    drive = drive_for(respond, wanted)
    used = drive[: round(RATE * SECONDS)]
    steps = np.diff(drive, axis=0) * RATE
    return Need(float(np.abs(drive).max()), float(np.sqrt((used**2).mean(axis=0)).max()), float(np.abs(steps).max()))


def drive_for(respond: Respond, wanted: Wanted) -> np.ndarray:
    """Return the drive for 1 m/s^2 at every sensor, shape (RATE ROOM, coils), V per m/s^2."""
    spectrum = np.fft.rfft(wanted.signal)
    frequency = np.fft.rfftfreq(round(RATE * ROOM), 1 / RATE)
    inside = np.flatnonzero((frequency > 0.7 * wanted.first) & (frequency < 1.2 * wanted.last))
    response = respond(frequency[inside])
    drives = np.zeros((len(frequency), response.shape[2]), complex)
    drives[inside] = inverse(response).sum(axis=2) * spectrum[inside, None]
    whole: np.ndarray = np.fft.irfft(drives, round(RATE * ROOM), axis=0)
    return whole


def inverse(response: np.ndarray) -> np.ndarray:
    """Return a bounded inverse of G, shape (bins, coils, sensors), V per m/s^2; `response` (bins, sensors, coils)."""
    adjoint = response.conj().swapaxes(-1, -2)
    square = response @ adjoint
    size = WEIGHT * np.trace(square, axis1=-2, axis2=-1).real / square.shape[-1]
    bounded: np.ndarray = adjoint @ np.linalg.inv(square + size[:, None, None] * np.eye(square.shape[-1]))
    return bounded
