"""One axis of the stage behind the link excited, and heard sample by sample: for identification."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ctlblocks import Graph
from ctlblocks.recording import Recording
from ctlblocks.replay import Replay
from rigkit.priority import undisturbed
from rigkit.stop import Stopped
from stagectl.link.blocks import Excite
from stagectl.link.bus import LinkError
from stagectl.link.capture import Capture
from stagectl.link.clock import run_linked
from stagectl.link.stage_link import StageLink
from stagectl.wire.messages import AXES, BLOCK, LONGEST_AHEAD, STATUS, Drive

_TAIL = LONGEST_AHEAD + 3 * STATUS.period
"""s at rest after an excitation: the stage plays what waits, and says that it has."""


class SamplesLost(LinkError):
    """An excitation in which not every sample was played, or heard, in time."""


@dataclass(frozen=True)
class Heard:
    """What an excitation gave, each of shape (samples, 3).

    Parameters
    ----------
    voltage : array, V
        As let out by the stage's guard.
    extension, position : arrays, m
        As its loops read them.
    """

    voltage: np.ndarray
    extension: np.ndarray
    position: np.ndarray


def excited(
    link: StageLink, drive: Drive, axis: int, deviation: np.ndarray, lead: float, stopped: Callable[[], bool]
) -> Heard:
    """Excite an axis, and return what the stage did; the stage is at mid-travel, in closed loop, before and after.

    Parameters
    ----------
    link : StageLink, open, of form "fd"
    drive : Drive
    axis : int, counted from 0
    deviation : array, shape (samples,), V or m
        From rest, as the wire can carry it (`wire.samples.rounded`).
    lead : float, s
        At rest before it, in which the stage opens its loop.
    stopped : callable() -> bool

    Raises
    ------
    LinkFault : a fault has latched; the stage goes to rest.
    SamplesLost : a part of it was not played, or not heard, as it should; nothing of it is to be used.
    Stopped : it was asked for.
    """
    before, blocks = round(lead * link.rate / BLOCK), -(-len(deviation) // BLOCK)
    after = round(_TAIL * link.rate / BLOCK)
    whole = np.zeros(((before + blocks + after) * BLOCK, len(AXES)))
    whole[before * BLOCK : before * BLOCK + len(deviation), axis] = deviation
    graph = _graph(link, drive, whole)
    capture = Capture(len(whole) // BLOCK + after)
    with undisturbed():
        link.excite(drive, axis, capture)
        first, refused = link.sent, link.references.refused
        try:
            if run_linked(graph, link, len(whole) // BLOCK, stopped) < len(whole) // BLOCK:
                raise Stopped("stopped")
        finally:
            if not link.reason:
                link.stop()
    if count := link.references.refused - refused:  # what follows would be played too early
        raise SamplesLost(f"this program stood still: {count} samples found no room on their way to the stage")
    start = capture.start(first, before + blocks)
    if isinstance(start, str):
        raise SamplesLost(start)
    found = {name: capture.samples(name, start + before, blocks) for name in ("voltage", "extension", "position")}
    for each in found.values():
        if isinstance(each, str):
            raise SamplesLost(each)
    heard = {name: np.asarray(each)[: len(deviation)] for name, each in found.items()}
    return Heard(heard["voltage"], heard["extension"], heard["position"] + link.link.origin)


def _graph(link: StageLink, drive: Drive, whole: np.ndarray) -> Graph:
    send = Excite(link, drive)
    graph = Graph(link.rate, link.frames)
    wanted = Recording(AXES, (send.inputs[0].unit,) * len(AXES), link.rate, whole)
    graph.add("wanted", Replay(wanted, {"deviation": AXES}))
    graph.add("send", send)
    graph.connect("wanted.deviation", "send.deviation")
    graph.prepare()
    return graph
