"""How to build the Blocks of the stage's daemon, for the conformance suite."""

from ctlblocks import Block
from rigkit.faults import FaultTable
from stagectl.config import StageConfig
from stagectl.daemon.monitor import Monitor
from stagectl.daemon.spoiled import SpoiledSensors, sensor_names
from stagectl.setup import Setup
from tests.contract.conformance import Example


def _spoiled() -> Block:
    config = StageConfig()
    table = FaultTable(sensor_names(config))
    table.inject("position_x", "hum")
    table.inject("extension_z", "x10")
    return SpoiledSensors(table, config)


STAGE_DAEMON_EXAMPLES: dict[type[Block], Example] = {
    Monitor: Example(lambda: Monitor(Setup(StageConfig(), (), ())), rate=10_000.0),
    SpoiledSensors: Example(_spoiled, rate=10_000.0),
}
