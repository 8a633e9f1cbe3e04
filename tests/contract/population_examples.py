"""How to build the Blocks of the population, for the conformance suite."""

from ctlblocks import Block
from firmware_sim.population.stage_block import Stage
from tests.contract.conformance import Example

POPULATION_EXAMPLES: dict[type[Block], Example] = {
    Stage: Example(lambda: Stage(seed=3, family="lugre-guide"), rate=10_000.0),
}
