"""What is measured of the stage now, against its limits."""

from collections.abc import Iterator

import numpy as np

from rigkit.experiment.pace import Pace
from rigkit.service.show import Gauge
from stagectl.config import StageConfig
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import State


def motion(config: StageConfig, position: np.ndarray, voltage: np.ndarray) -> Iterator[Gauge]:
    """Give where each axis is in its travel, and its voltage against the limits.

    Parameters
    ----------
    config : StageConfig
    position : array, shape (axes,), m
    voltage : array, shape (axes,), V
    """
    limits = config.limits
    for axis, place, volts in zip(config.stage.axes, position.tolist(), voltage.tolist(), strict=True):
        yield Gauge(f"position_{axis}", f"Travel {axis}", place, "m", *limits.travel)
        yield Gauge(f"voltage_{axis}", f"Voltage {axis}", volts, "V", *limits.voltage)


def driven(config: StageConfig, voltage: np.ndarray) -> Iterator[Gauge]:
    """Give what is put out to a simulated stage: how far each voltage is from rest.

    Parameters
    ----------
    config : StageConfig
    voltage : array, shape (axes,), V
    """
    for axis, volts in zip(config.stage.axes, voltage.tolist(), strict=True):
        away = volts - config.limits.rest_voltage
        yield Gauge(f"drive_{axis}", f"Voltage {axis} from rest", away, "V", is_output=True)


def paced(pace: Pace) -> Iterator[Gauge]:
    """Give whether a simulation keeps to the clock."""
    yield Gauge("late", "Late steps of the simulation", pace.late, "1")
    yield Gauge("behind", "Simulation behind the clock", pace.behind, "s")


def linked(link: StageLink) -> Iterator[Gauge]:
    """Give whether the stage is led, as it says itself, and what became of the frames on the link."""
    counts, led = link.counts, link.state not in (State.HOLDING, State.FAULT)
    yield Gauge("led", "Stage follows (1), or is held at mid-travel (0)", float(led), "1", is_output=True)
    yield Gauge("link_lost", "Blocks from the stage lost", counts.lost, "1")
    yield Gauge("link_late", "Blocks from the stage late", counts.late, "1")
    yield Gauge("link_garbled", "Frames garbled", counts.garbled, "1")
    yield Gauge("link_silence", "Longest silence of the stage", counts.longest_silence, "s", high=link.link.stall)
    if link.link.relay.bus:
        yield Gauge("relay_beats", "Heartbeats to the relay", link.beats, "1")
    status = link.status
    if status is not None:
        yield Gauge("reference_lost", "Blocks to the stage lost", status.lost, "1")
        yield Gauge("underruns", "Blocks the stage had to wait for", status.underruns, "1")
