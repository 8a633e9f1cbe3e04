"""How to build the Blocks of the stage's daemon, and of a reference that is held, for the conformance suite."""

import numpy as np

from ctlblocks import Block
from ctlblocks.recording import Recording
from rigkit.faults import FaultTable
from stagectl.config import StageConfig
from stagectl.daemon.stage.monitor import Monitor
from stagectl.daemon.stage.spoiled import SpoiledSensors, sensor_names
from stagectl.experiments.piezo.held_reference import HeldReference
from stagectl.experiments.piezo.setup import Setup
from tests.contract.conformance import Example


def _spoiled() -> Block:
    config = StageConfig()
    table = FaultTable(sensor_names(config))
    table.inject("position_x", "hum")
    table.inject("extension_z", "x10")
    return SpoiledSensors(table, config)


def _wanted() -> Recording:
    wave = 1e-5 * np.column_stack([np.sin(np.arange(500) / 30 + axis) for axis in range(3)])
    return Recording(("x", "y", "z"), ("m",) * 3, 10_000.0, wave)


STAGE_DAEMON_EXAMPLES: dict[type[Block], Example] = {
    HeldReference: Example(lambda: HeldReference(_wanted(), 0.01, slice(100, 400)), rate=10_000.0),
    Monitor: Example(lambda: Monitor(Setup(StageConfig(), (), ())), rate=10_000.0),
    SpoiledSensors: Example(_spoiled, rate=10_000.0),
}
