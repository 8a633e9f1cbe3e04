"""How to build the Blocks of force-controlled milling, for the conformance suite."""

import numpy as np

from ctlblocks import Block
from firmware_sim.feed_blocks import FedTool
from firmware_sim.oak_blocks import OakCut
from stagectl.experiments.feed.constant_feed import ConstantFeed
from stagectl.experiments.feed.feed_seen import FeedSeen
from stagectl.experiments.feed.segment_move import SegmentMove
from stagectl.planning.problem import Pocket, milling_types
from stagectl.robot.arm import irb140
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from stagectl.robot.segment_config import SegmentTask
from stagectl.robot.tool_place import ToolPlace
from tests.contract.conformance import Example

POCKET = Pocket(6, 6, 2, "EW", dict.fromkeys(milling_types(2, "EW"), 1.0))

FEED_EXAMPLES: dict[type[Block], Example] = {
    FedTool: Example(FedTool, rate=250.0),
    OakCut: Example(lambda: OakCut(origin=(0.0, 0.0, 0.05)), rate=2_000.0),
    SegmentMove: Example(lambda: SegmentMove(SegmentTask(), POCKET), rate=250.0),
    FeedSeen: Example(lambda: FeedSeen(irb140(), 0.1), rate=250.0),
    ConstantFeed: Example(lambda: ConstantFeed(2.0, 3.0), lambda block: block.change(0.01), 250.0),
    ToolPlace: Example(lambda: ToolPlace(irb140(), 0.1, np.full(6, 0.5), np.array([0.3, 0.3, 0.5])), rate=250.0),
    FeedForce: Example(lambda: FeedForce(ForceFeed(force=0.1), nominal_velocity(250.0)), rate=250.0),
}
