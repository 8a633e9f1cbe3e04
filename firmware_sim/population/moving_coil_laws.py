"""What the family `moving-coil` draws about large signals: motor, suspension, seal, heat and what softens."""

import numpy as np

from firmware_sim.plants.moving_coil import Heating, LargeSignal, MovingCoil
from firmware_sim.plants.suspension_drift import Softening
from firmware_sim.population.draw import Quantity
from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams

FIELD_LEFT, SPRING_LEFT = (0.82, 0.97), (0.75, 0.95)
"""1: Bl and compliance at x_max over those at rest.  The first of each is where x_max ends: 10 % distortion [Klippel,
Assessment of voice-coil peak displacement X_max, J. Audio Eng. Soc. 51 (2003) 307; IEC 62458].  One of the two is
there, the other is drawn."""
FLAT = (0.0, 1.0)
"""1: the part of Bl's fall that goes with the fourth power: none in a coil as long as its gap, most in an overhung one
[Gander, J. Audio Eng. Soc. 29 (1981) 10]."""
OFFSET = 0.2
"""1: of x_max, how far a coil may sit off the field's middle [Klippel 2006: 0.2 to 2 mm are common]."""
ASYMMETRIC, STEEP = (0.0, 0.5), (0.0, 0.7)
"""1: the part of the stiffening that is odd, and the part of the rest that goes with the fourth power."""
MODULATION = (0.03, 0.5)
"""1: how L_e falls outwards; over sqrt(2) at x_max.  0.03 is with a copper ring, 0.5 without [Klippel 2006]."""
SATURATING, SATURATION = (0.03, 0.3), (1.0, 5.0)
"""1: the part of L_e that saturates, and the current at which it does, over that at x_max [Klippel 2006, L_e(i)]."""
SPEED = (1.0, 10.0)
"""1: speed at which R_ms is up by sqrt(2), over that of x_max at resonance: Klippel, Dynamical measurement of nonlinear
damping, AES 135th Convention (2013), R_ms(v) up by a tenth to two thirds."""
RUBS, RUBBING, GIVES = 0.35, (0.001, 0.03), (0.005, 0.1)
"""1: vibrators with a seal; its friction over the peak force of the reference; and how far it gives before it slips,
over the reference's excursion.  An O-ring gives some hundredths of a millimetre."""
SPREAD = np.array([0.25, 0.5, 1.0, 2.0])
"""1: where the four parts of the seal slip, over their mean or so."""
WARM, TIME = (0.5, 40.0), (0.5, 20.0)
"""K: how much warmer than its magnet a coil would become if the reference never ended; s.  Rated power makes 100 to
150 K, and its time is seconds to tens of seconds [Button 1992]."""
MAGNET, MAGNET_TIME = (0.1, 1.0), (600.0, 3600.0)
"""1: rise of the magnet over that of the coil above it; s."""
SOFTENING, SOFTENING_TIME = (0.005, 0.1), (30.0, 1800.0)
"""1: stiffness lost by work; s [Klippel 2011: 5 to 30 % in hours near x_max, some of it for good]."""
WANDERS, WALK = 0.5, (4e-4, 1e-2)
"""1: vibrators whose stiffness wanders with the weather; 1/sqrt(minute): twice what the seeded families'
frequencies do."""


def draw_large(
    streams: Streams, small: MovingCoil, excursion: float, reached: float, current: float, first: float
) -> tuple[LargeSignal, tuple[Quantity, ...]]:
    """Draw what changes with excursion, speed and current.

    Parameters
    ----------
    streams : Streams
    small : MovingCoil
        Linear.
    excursion, reached : float, m
        x_max, and the peak of the reference.
    current : float, A
        The peak of the reference.
    first : float, Hz
        The first resonance.
    """
    units, rng = len(small.moving.mass), streams("what ends first")
    ends, field_left = rng.uniform() < 0.5, float(log_uniform(rng, *FIELD_LEFT))
    spring_left = float(log_uniform(rng, *SPRING_LEFT))
    field_left, spring_left = (FIELD_LEFT[0], spring_left) if ends else (field_left, SPRING_LEFT[0])
    rng = streams("field")
    fall, flat = 1 / field_left - 1, float(rng.uniform(*FLAT))
    offset = tuple(map(float, rng.uniform(-OFFSET, OFFSET, units)))
    rng = streams("iron")
    modulation, saturating = float(log_uniform(rng, *MODULATION)), float(log_uniform(rng, *SATURATING))
    saturation = float(log_uniform(rng, *SATURATION)) * current * excursion / reached
    speed = float(log_uniform(streams("speed"), *SPEED)) * 2 * np.pi * first * excursion
    seal, rubbing = _seal(streams, small, reached, current)
    large = LargeSignal(
        excursion,
        (fall * (1 - flat), fall * flat),
        offset,
        _spring(streams, 1 / spring_left - 1),
        modulation,
        saturating,
        saturation,
        speed,
        seal,
    )
    said = (
        Quantity("Bl left at x_max", field_left, "1"),
        Quantity("compliance left at x_max", spring_left, "1"),
        Quantity("coils' offset over x_max", offset, "1"),
        Quantity("inductance lost at x_max", modulation / float(np.sqrt(2)), "1"),
        Quantity("inductance that saturates", saturating, "1"),
        *rubbing,
    )
    return large, said


def _spring(streams: Streams, rise: float) -> tuple[float, float, float]:
    """Return how stiffness goes with excursion, so that it is up by `rise` at the harder end."""
    rng = streams("spring")
    odd, steep = float(rng.uniform(*ASYMMETRIC)), float(rng.uniform(*STEEP))
    even = (1 - odd) * rise
    return odd * rise * float(rng.choice([-1.0, 1.0])), even * (1 - steep), even * steep


def _seal(
    streams: Streams, small: MovingCoil, reached: float, current: float
) -> tuple[tuple[tuple[float, float], ...], tuple[Quantity, ...]]:
    rng = streams("seal")
    has_one, part, gives = rng.uniform() < RUBS, float(log_uniform(rng, *RUBBING)), float(log_uniform(rng, *GIVES))
    if not has_one:
        return (), ()
    force = part * current * float(small.motor.factor.mean())
    each = force / len(SPREAD)
    seal = tuple((float(each / (gives * reached * spread)), each) for spread in SPREAD)
    return seal, (Quantity("friction over the reference's force", part, "1"), Quantity("friction", force, "N"))


def draw_heating(streams: Streams, power: float) -> tuple[Heating, tuple[Quantity, ...]]:
    """Draw how coils and magnets warm up.

    Parameters
    ----------
    streams : Streams
    power : float, W
        Of the reference, in the coil that has most.
    """
    rng = streams("heat")
    warm, time = float(log_uniform(rng, *WARM)), float(log_uniform(rng, *TIME))
    magnet, later = float(log_uniform(rng, *MAGNET)), float(log_uniform(rng, *MAGNET_TIME))
    said = (
        Quantity("coil's warming by the reference", warm, "K"),
        Quantity("coil's thermal time", time, "s"),
        Quantity("magnet's warming by the reference", magnet * warm, "K"),
        Quantity("magnet's thermal time", later, "s"),
    )
    return Heating(warm / power, time, magnet * warm / power, later), said


def draw_softening(streams: Streams) -> tuple[Softening, tuple[Quantity, ...]]:
    """Draw how suspensions soften and wander."""
    rng = streams("softening")
    part, seconds = float(log_uniform(rng, *SOFTENING)), float(log_uniform(rng, *SOFTENING_TIME))
    rng = streams("walk")
    wanders, walk = rng.uniform() < WANDERS, float(log_uniform(rng, *WALK))
    said = [Quantity("stiffness lost by work", part, "1"), Quantity("time of that", seconds, "s")]
    if wanders:
        said.append(Quantity("walk of the stiffness", walk, "1/sqrt(minute)"))
    return Softening(part, seconds, walk if wanders else 0.0), tuple(said)
