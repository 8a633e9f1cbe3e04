"""What a vibrator's sensors hear beside it, and how it drifts: mains, noise, ships; a walk, a trend, a jump.

Levels are those of the verdict: of a line of the spectrum of a shot against the limit, 40 dB below the reference.
"""

import numpy as np

from firmware_sim.plants.mode_drift import Drift
from firmware_sim.plants.pickup import Mains, Noise, Ships
from firmware_sim.plants.structure import Structure
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.references import SECONDS
from firmware_sim.population.streams import Streams

LIMIT = 0.01
"""1 re the reference: the objective, -40 dB."""
RATE = 44_100
"""samples/s to which levels of white noise belong; at another rate its density is another."""
SILENT, HUM = 0.2, (-40.0, 10.0)
"""1: vibrators without hum; dB re the limit of the strongest harmonic that is judged, in the others."""
HARMONICS, JUDGED = 12, (100.0, 645.0)
OFF, WANDER = 0.05, (0.001, 0.02)
"""Hz: how far the mains are off 50 or 60, and how far they wander."""
WHITE, RISING, SHIP = (-60.0, -16.0), (-60.0, -16.0), (-20.0, 10.0)
"""dB re the limit: rms of a line of white noise, of 1/f noise at 100 Hz, and of a ship at its closest."""
RISES, SHIPS = 0.6, 0.4
"""1: vibrators with 1/f noise, and with ships."""
DRIFTS = ("still", "walk", "trend", "jump")


def draw_mains(streams: Streams, sensors: int, line: float) -> tuple[Mains, tuple[Quantity, ...]]:
    """Draw the mains.

    Parameters
    ----------
    streams : Streams
    sensors : int
    line : float, m/s^2 s
        The reference's spectrum.
    """
    nominal = float(streams("mains").choice([50.0, 60.0]))
    frequency = nominal + float(streams("mains frequency").uniform(-OFF, OFF))
    wander = float(log_uniform(streams("mains wander"), *WANDER))
    rng = streams("hum")
    silent, level = rng.uniform() < SILENT, float(rng.uniform(*HUM))
    said = Quantity("mains", frequency, "Hz")
    if silent:
        none = np.zeros((0, sensors))
        return Mains(frequency, wander, none, none), (said, Quantity("hum", "silent"))
    order = np.arange(1, HARMONICS + 1)
    rng = streams("harmonics")
    odd, even = log_uniform(rng, 0.3, 1.0, HARMONICS), log_uniform(rng, 0.02, 1.0, HARMONICS)
    size = np.where(order % 2 == 1, odd, even)[:, None] / order[:, None] ** rng.uniform(0.3, 1.5)
    size = size * log_uniform(rng, 0.5, 2.0, HARMONICS * sensors).reshape(HARMONICS, sensors)
    judged = (order * nominal >= JUDGED[0]) & (order * nominal <= JUDGED[1])
    tone = LIMIT * line * 2 / SECONDS  # the line of a tone is its amplitude times half the time
    size *= tone * 10 ** (level / 20) / size[judged].max()
    phase = rng.uniform(0, 2 * np.pi, (HARMONICS, sensors))
    return (
        Mains(frequency, wander, size * np.cos(phase), size * np.sin(phase)),
        (said, Quantity("hum", level, "dB re the limit"), Quantity("mains wander", wander, "Hz")),
    )


def draw_noise(streams: Streams, sensors: int, line: float) -> tuple[Noise, Ships, tuple[Quantity, ...]]:
    """Draw noise and ships.

    Parameters
    ----------
    streams : Streams
    sensors : int
    line : float, m/s^2 s
        The reference's spectrum.
    """
    whole = LIMIT * line * float(np.sqrt(RATE / SECONDS))  # the line of white noise is its rms times sqrt(time / rate)
    white, rising = float(streams("white noise").uniform(*WHITE)), float(streams("rising noise").uniform(*RISING))
    rises, passes = streams("kinds of noise").uniform(size=2) < (RISES, SHIPS)
    each = log_uniform(streams("sensors"), 0.7, 1.4, 2 * sensors).reshape(2, sensors)
    said = [Quantity("white noise", white, "dB re the limit")]
    swell = float(streams("swell").uniform(0.0, 0.5))
    if rises:
        said += [Quantity("1/f noise at 100 Hz", rising, "dB re the limit"), Quantity("swell", swell, "1")]
    noise = Noise(
        whole * 10 ** (white / 20) * each[0], rises * whole * 10 ** (rising / 20) * each[1], swell if rises else 0.0
    )
    rng = streams("ships")
    loud, often = float(rng.uniform(*SHIP)), float(log_uniform(rng, 0.05, 1.0)) * bool(passes)
    seconds, centre = float(log_uniform(rng, 1.0, 20.0)), float(log_uniform(rng, 60.0, 400.0))
    blade, depth = float(rng.uniform(4.0, 16.0)), float(rng.uniform(0.2, 0.9))
    gains = log_uniform(streams("ship's paths"), 0.5, 1.0, sensors)
    if passes:
        said += [
            Quantity("ships", often, "1/minute"),
            Quantity("a ship", loud, "dB re the limit"),
            Quantity("a ship's passage", seconds, "s"),
            Quantity("a ship's band", centre, "Hz"),
        ]
    ships = Ships(often, whole * 10 ** (loud / 20), seconds, centre, blade, depth, gains)
    return noise, ships, tuple(said)


def draw_drift(streams: Streams, structure: Structure) -> tuple[Drift, tuple[Quantity, ...]]:
    """Draw how the modes of a structure move."""
    kind = DRIFTS[streams("drift").integers(len(DRIFTS))]
    said = Quantity("drift", kind)
    if kind == "walk":
        walk = float(log_uniform(streams("walk"), 2e-4, 5e-3))
        return Drift(walk=walk), (said, Quantity("walk", walk, "1/sqrt(minute)"))
    if kind == "trend":
        rng = streams("trend")
        size, seconds = float(log_uniform(rng, 0.002, 0.04)), float(log_uniform(rng, 120.0, 3600.0))
        trend = size * float(rng.choice([-1.0, 1.0]))
        drift = Drift(trend=trend, trend_seconds=seconds)
        return drift, (said, Quantity("trend", trend, "1"), Quantity("trend lasts", seconds, "s"))
    if kind == "jump":
        rng = streams("jump")
        mode, widths = int(rng.integers(len(structure.frequency))), float(rng.uniform(0.3, 2.0))
        widths, at = widths * float(rng.choice([-1.0, 1.0])), float(rng.uniform(20.0, 150.0))
        where = Quantity("jumping mode", float(structure.frequency[mode]), "Hz")
        far = Quantity("jump", widths, "half-power bandwidths")
        return Drift(jump_mode=mode, jump_widths=widths, jump_at=at), (said, where, far, Quantity("jump at", at, "s"))
    return Drift(), (said,)
