"""A live run of mid-ranging: the robot over its port, whose report is the clock, and the stage over its link."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack

import numpy as np

from ctlblocks import Block, Graph
from ctlblocks.recording import Recording
from rigkit.priority import undisturbed
from stagectl.link.bus import LinkError
from stagectl.link.clock import run_linked
from stagectl.link.stage_link import StageLink
from stagectl.robot.config import CellConfig
from stagectl.robot.midranging.config import MidrangeConfig
from stagectl.robot.midranging.live_pair import LivePair, LiveSeen, LiveSend
from stagectl.robot.midranging.wiring import MEASURED, refuse_unready, split, wire
from stagectl.robot.port import RobotPort
from stagectl.robot.program import RobotProgram, begin_motion
from stagectl.robot.tracker import TrackerLine
from stagectl.wire.egm import RATE
from stagectl.wire.messages import AXES, REFERENCE
from stagectl.wire.samples import largest

Look = Callable[[Graph, LivePair], object]
"""Called once the wires are open, and before each tick."""


def unseen(graph: Graph, pair: LivePair) -> None:  # noqa: ARG001 (an observer's own arguments)
    """Look at nothing."""


class LiveFault(LinkError):
    """A live run that a fault has ended.

    Parameters
    ----------
    reason : str
    recorded : list of Recording
        All that was recorded until then, its lead as well, a recording an axis.
    """

    def __init__(self, reason: str, recorded: list[Recording]) -> None:
        super().__init__(reason)
        self.recorded = recorded


def run_live(
    made: Block,
    wanted: np.ndarray,
    names: Sequence[str],
    cell: CellConfig,
    stopped: Callable[[], bool] = lambda: False,
    look: Look = unseen,
) -> list[Recording]:
    """Run one controller on the robot and the stage; return what was recorded, a recording an axis.

    Whatever ends it, the robot is held where it is and the stage goes to mid-travel.

    Parameters
    ----------
    made : Block
        InternalModel or ValvePosition, of as many axes as `wanted` has.
    wanted : array, shape (samples, axes), m
        The reference, from where the robot is and the stage's mid-travel.
    names : sequence of str
        Which axis each column is: x, y or z, of the stage and of the robot's base.
    cell : CellConfig
    stopped : callable() -> bool
    look : callable(Graph, LivePair)
        For whoever watches: called once the wires are open, and before each tick.

    Raises
    ------
    ValueError : an axis that the stage has not, another rate than the robot's, or more than the stage moves.
    LinkError : a wire that cannot be had.
    LiveFault : a fault, by its reason.
    """
    config, axes = cell.midranging, wanted.shape[1]
    _refuse_other_axes(config, names)
    _refuse_far(config)
    lead = round(config.session.lead * RATE)
    whole = np.concatenate([np.zeros((lead, axes)), wanted])
    _compile(made)
    with ExitStack() as stack:
        pair = _opened(stack, cell, names)
        graph = Graph(RATE)
        graph.add("seen", LiveSeen(pair))
        graph.add("send", LiveSend(pair, config.session.smoothing))
        record = wire(graph, made, whole, {name: (f"seen.{name}", False) for name in MEASURED}, "send")

        def over() -> bool:
            look(graph, pair)
            return stopped()

        look(graph, pair)
        try:
            with undisturbed():
                _start(pair, cell)
                run_linked(graph, pair.robot, len(whole), over)
        except LinkError as fault:
            raise LiveFault(str(fault), split(record, axes, 0) if record.position else []) from fault
    if record.position <= lead:
        raise LiveFault(f"stopped after {record.position / RATE:g} s, before the reference began", [])
    try:
        refuse_unready(record, lead)
    except ValueError as fault:
        raise LiveFault(str(fault), split(record, axes, 0)) from fault
    return split(record, axes, lead)


def _refuse_other_axes(config: MidrangeConfig, names: Sequence[str]) -> None:
    if not set(names) <= set(AXES) or config.pair.rate != RATE:
        raise ValueError(
            f"a live run has the axes {', '.join(names)} at midranging.pair.rate {config.pair.rate:g} samples/s, "
            f"must be of {', '.join(AXES)} at {RATE:g}"
        )


def _refuse_far(config: MidrangeConfig) -> None:
    """Refuse a travel beyond what the wire carries; the estimation phase stays within it."""
    far, pair = largest(REFERENCE) - abs(config.pair.middle), config.pair
    if not pair.travel <= far:
        raise ValueError(
            f"midranging.pair.travel is {pair.travel:g} m, must be <= {far:.3g} m in a live run: the stage is asked "
            "for no more"
        )


def _opened(stack: ExitStack, cell: CellConfig, names: Sequence[str]) -> LivePair:
    """Open every wire: the stage's, the robot's, and the tracker's where it is wanted."""
    config = cell.midranging
    cell = cell.model_copy(update={"robot": cell.robot.model_copy(update={"mode": "pose"})})
    stage = stack.enter_context(StageLink(cell.link))
    robot = stack.enter_context(RobotPort(cell))
    tracked = config.session.seen == "tracker"
    tracker = stack.enter_context(TrackerLine(cell.tracker, robot.hold)) if tracked else None
    gain = config.inner.numerator[0] / config.inner.denominator[0]
    return LivePair(stage, robot, tuple(AXES.index(name) for name in names), gain, tracker)


def _start(pair: LivePair, cell: CellConfig) -> None:
    """Let stage and robot follow, from where they are."""
    pair.stage.start()
    if cell.robot.commands:
        peer = pair.robot.conversation.peer
        with RobotProgram(cell.robot, peer[0] if peer is not None else cell.robot.listen) as program:
            begin_motion(pair.robot, program)
    pair.robot.start()
    pair.begin()
    if pair.tracker is not None:
        pair.tracker.start()


def _compile(made: Block) -> None:
    """Have the controller's kernel compiled before a robot waits for it."""
    made.prepare(RATE, 1)
    made.process(*(np.zeros((1, port.width)) for port in (*made.inputs, *made.outputs)))
