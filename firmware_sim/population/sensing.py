"""The sensors of a vibrator: delays, one that resonates, one that is not quite linear; and all that they pick up."""

import numpy as np

from firmware_sim.plants.reception import Reception, Sensors
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams
from firmware_sim.population.surroundings import draw_mains, draw_noise

DELAY, PATHS = (1e-3, 29e-3), 1e-3
"""s, and by how much it differs from sensor to sensor, at most."""
PECULIAR = 0.35
"""1: vibrators with a sensor that resonates, and with one that is not quite linear."""
RESONANCE, DAMPING = (700.0, 6000.0), (0.01, 0.7)
"""Hz and 1."""
BEND, RANGE = 1e-3, (2.0, 10.0)
"""1: what it is off by at the end of its range, which is so many times the reference level."""


def draw_sensors(streams: Streams, heard: int) -> tuple[Sensors, tuple[Quantity, ...]]:
    """Draw sensors as far as they are linear.

    Parameters
    ----------
    streams : Streams
    heard : int
        How many.
    """
    rng = streams("delay")
    delay = float(log_uniform(rng, *DELAY)) + rng.uniform(0, PATHS, heard)
    rng = streams("sensor resonance")
    which, has_one = int(rng.integers(heard)), rng.uniform() < PECULIAR
    resonance, damping = np.zeros(heard), np.full(heard, 0.5)
    frequency, ratio = float(log_uniform(rng, *RESONANCE)), float(log_uniform(rng, *DAMPING))
    said = [Quantity("delays", tuple(map(float, 1e3 * delay)), "ms")]
    if has_one:
        resonance[which], damping[which] = frequency, ratio
        said += [
            Quantity("resonant sensor", which + 1),
            Quantity("resonant sensor's resonance", frequency, "Hz"),
            Quantity("resonant sensor's damping", ratio, "1"),
        ]
    return Sensors(delay, resonance, damping, np.zeros((heard, 2))), tuple(said)


def draw_reception(
    streams: Streams, sensors: Sensors, level: float, line: float
) -> tuple[Reception, tuple[Quantity, ...]]:
    """Draw what is not linear about the sensors, and what they pick up.

    Parameters
    ----------
    streams : Streams
    sensors : Sensors
    level : float, m/s^2
        The reference's.
    line : float, s
        Its spectrum, m/s^2 s, over that.
    """
    heard = len(sensors.delay)
    rng = streams("sensor bend")
    which, has_one, cubic = int(rng.integers(heard)), rng.uniform() < PECULIAR, rng.uniform() < 0.5
    reach = level * float(log_uniform(rng, *RANGE))
    bend = np.zeros((heard, 2))
    said = []
    if has_one:
        bend[which, int(cubic)] = BEND / reach ** (2 if cubic else 1)
        said += [Quantity("nonlinear sensor", which + 1), Quantity("nonlinear sensor 0.1 % off at", reach, "m/s^2")]
    mains, humming = draw_mains(streams, heard, level * line)
    noise, ships, noisy = draw_noise(streams, heard, level * line)
    bent = Sensors(sensors.delay, sensors.resonance, sensors.damping, bend)
    return Reception(bent, mains, noise, ships), (*said, *humming, *noisy)
