"""The lasers of a run: whether they are read, what is refused of them, and how late what they see is compensated."""

import math

from stagectl.config import StageConfig
from stagectl.stage.deflection_parameters import refuse_corner
from stagectl.stage.laser_check import LaserLimits
from stagectl.wire.bus_load import laser_load

HELD = 1.5
"""Cycles of its laser that a reading is old in the mean: one when it comes, two before the next."""


def reads_laser(config: StageConfig) -> bool:
    """Whether a run needs what the lasers see.

    Parameters
    ----------
    config : StageConfig
    """
    return config.laser.on or config.deflection.on or config.session.compare


def laser_limits(config: StageConfig) -> LaserLimits:
    """Return what the stage's lasers can show.

    Parameters
    ----------
    config : StageConfig
    """
    laser = config.laser
    return LaserLimits(laser.rate, laser.late, laser.stuck, laser.speed)


def lateness(config: StageConfig) -> float:
    """Return how old what is taken off a reference is, s, for what moves slowly.

    Parameters
    ----------
    config : StageConfig
    """
    deflection = config.deflection
    late = HELD / config.laser.rate if config.session.live else deflection.delay / config.stage.rate
    return late + 1.0 / (2.0 * math.pi * deflection.corner)


def refuse_unfit_lasers(config: StageConfig) -> None:
    """Refuse lasers that are too slow for what is asked of them.

    Parameters
    ----------
    config : StageConfig

    Raises
    ------
    ValueError : the corner frequency is too high for the laser's rate; in process, `deflection.delay` is less than a
        cycle of the laser, or the simulated laser has another rate; live, the bus is too slow for what lasers see.
    """
    laser, deflection, link = config.laser, config.deflection, config.link
    if deflection.on:
        refuse_corner(deflection.corner, laser.rate)
    if config.session.live:
        load = laser_load(link.form, link.bitrate, link.data_bitrate)
        if reads_laser(config) and load > 1:
            raise ValueError(
                f"link.bitrate is {link.bitrate} bit/s with link.form {link.form}, must be faster to read lasers over "
                f"it: the bus would be busy for {100 * load:.0f} % of the time"
            )
        return
    simulated = config.simulator.options.get("laser_rate", laser.rate)
    if deflection.on and simulated != laser.rate:
        raise ValueError(f"simulator.options.laser_rate is {simulated:g} Hz, must be laser.rate, {laser.rate:g} Hz")
    cycle = math.floor(config.stage.rate / laser.rate)
    if deflection.on and deflection.delay < cycle:
        raise ValueError(
            f"deflection.delay is {deflection.delay} samples, must be >= {cycle}, one cycle of a laser of "
            f"{laser.rate:g} readings/s"
        )
