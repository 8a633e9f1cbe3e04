"""Which piezo stage, and what is wrong with it: the keywords of the simulated stage."""

from dataclasses import dataclass

from firmware_sim.plants.options import option, refuse_wrong_options


@dataclass(eq=False, kw_only=True)
class PiezoStageOptions:
    """What the simulated piezo stage is built with.

    Parameters
    ----------
    seed : int
        Which stage: masses, stiffnesses, damping, actuators, sensor gains and noise are drawn from it.
    frequency_scale : float, 1
        Multiplies every natural frequency, as if all that moves were lighter; static stiffness and gains stay.
    hysteresis, creep, coupling, noise : float, 1
        Scale the width of the loops, the creep, what couples x and z, and the noise of every sensor.
    delay : int, samples
        From the mechanics to the sensors' outputs, beside the sample that a converter holds its value.
    laser_rate : float, samples/s
        Of the laser sensor; it puts out what it saw one of its own cycles ago.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    seed: int = option(1, "", 0)
    frequency_scale: float = option(1.0, "1", 0.5, 1.5)
    hysteresis: float = option(1.0, "1", 0.0, 2.0)
    creep: float = option(1.0, "1", 0.0, 5.0)
    coupling: float = option(1.0, "1", 0.0, 5.0)
    noise: float = option(1.0, "1", 0.0, 100.0)
    delay: int = option(1, "", 0, 100)
    laser_rate: float = option(5_000.0, "Hz", 10.0, 50_000.0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)
