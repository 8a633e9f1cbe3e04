"""How to build the Blocks of the population, for the conformance suite."""

from ctlblocks import Block
from firmware_sim.population.cell_blocks import ClampedArm, Cut, ForceSensor, Robot, Tracker
from firmware_sim.population.pair_block import Pair
from firmware_sim.population.stage_block import Stage
from firmware_sim.population.vibrators import Vibrator
from tests.contract.conformance import Example

POPULATION_EXAMPLES: dict[type[Block], Example] = {
    ClampedArm: Example(lambda: ClampedArm(seed=2), rate=250.0, silent=16),
    Cut: Example(lambda: Cut(cell=4, family="chatter"), rate=10_000.0),
    ForceSensor: Example(lambda: ForceSensor(seed=2), rate=8_000.0),
    Robot: Example(lambda: Robot(seed=2, arm="kuka"), rate=8_000.0),
    Tracker: Example(lambda: Tracker(seed=2), rate=300_000.0),
    Pair: Example(lambda: Pair(seed=5, family="flexible", gains=((0.5, 1.5),), disturbance=0.1), rate=250.0),
    Stage: Example(lambda: Stage(seed=3, family="lugre-guide"), rate=10_000.0),
    Vibrator: Example(lambda: Vibrator(seed=3)),
}
