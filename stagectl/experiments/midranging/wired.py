"""The wires of mid-ranging: the robot's, whose report is the clock, the stage's, and the tracker's."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from ctlblocks import Block
from stagectl.experiments.midranging.wired_blocks import LivePair
from stagectl.link.stage_link import StageLink
from stagectl.robot.config import CellConfig
from stagectl.robot.live.wires import begin_motion_of
from stagectl.robot.midranging_config import MidrangeConfig
from stagectl.robot.port import RobotPort
from stagectl.robot.tracker import TrackerLine
from stagectl.wire.messages import AXES, REFERENCE
from stagectl.wire.robot import RATE
from stagectl.wire.samples import largest


def refuse_unfit(config: MidrangeConfig, names: Sequence[str]) -> None:
    """Refuse, by ValueError, axes or a rate that the wires have not, and a travel beyond what they carry.

    Parameters
    ----------
    config : MidrangeConfig
    names : sequence of str
        Of the axes.
    """
    if not set(names) <= set(AXES) or config.pair.rate != RATE:
        raise ValueError(
            f"a live run has the axes {', '.join(names)} at midranging.pair.rate {config.pair.rate:g} samples/s, "
            f"must be of {', '.join(AXES)} at {RATE:g}"
        )
    far, pair = largest(REFERENCE) - abs(config.pair.middle), config.pair
    if not pair.travel <= far:
        raise ValueError(
            f"midranging.pair.travel is {pair.travel:g} m, must be <= {far:.3g} m in a live run: the stage is asked "
            "for no more"
        )


@contextmanager
def opened(cell: CellConfig, names: Sequence[str]) -> Iterator[LivePair]:
    """Open every wire: the stage's, the robot's, and the tracker's where it is wanted.

    Whatever ends the block, the robot is held where it is and the stage goes to mid-travel.

    Parameters
    ----------
    cell : CellConfig
    names : sequence of str
        Which axes: x, y or z, of the stage and of the robot's base.

    Raises
    ------
    LinkError : a wire that cannot be had.
    """
    config = cell.midranging
    cell = cell.model_copy(update={"robot": cell.robot.model_copy(update={"mode": "pose"})})
    with ExitStack() as stack:
        stage = stack.enter_context(StageLink(cell.link))
        robot = stack.enter_context(RobotPort(cell))
        tracked = config.session.seen == "tracker"
        tracker = stack.enter_context(TrackerLine(cell.tracker, robot.hold)) if tracked else None
        gain = config.inner.numerator[0] / config.inner.denominator[0]
        yield LivePair(stage, robot, tuple(AXES.index(name) for name in names), gain, tracker)


def start(pair: LivePair) -> None:
    """Let stage and robot follow, from where they are."""
    pair.stage.start()
    begin_motion_of(pair.robot)
    pair.robot.start()
    pair.begin()
    if pair.tracker is not None:
        pair.tracker.start()


def compile_kernel(made: Block) -> None:
    """Have a controller's kernel compiled before a robot waits for it."""
    made.prepare(RATE, 1)
    made.process(*(np.zeros((1, port.width)) for port in (*made.inputs, *made.outputs)))
