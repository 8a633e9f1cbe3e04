"""The clock of a graph behind the link: the stage's own crystal, a tick for each block that comes."""

from collections.abc import Callable

from ctlblocks.graph import Graph
from stagectl.link.bus import LinkError
from stagectl.link.priority import real_time
from stagectl.link.stage_link import StageLink


def run_linked(graph: Graph, link: StageLink, ticks: int, stopped: Callable[[], bool] = lambda: False) -> int:
    """Tick a prepared graph once for each block from the stage, `ticks` times or until `stopped`; return the ticks run.

    Two blocks that come at once make two ticks without a pause; none is left out.

    Parameters
    ----------
    graph : Graph, of the link's rate and frames
    link : StageLink, open
    ticks : int
    stopped : callable() -> bool

    Raises
    ------
    ValueError : the graph's frames are not the link's.
    LinkFault : a fault has latched.
    LinkError : no block has come for `link.patience`.
    """
    if graph.frames != link.frames:
        raise ValueError(f"the graph ticks by {graph.frames} frames, must be {link.frames} as on the wire")
    with real_time():
        samples = link.skip()
        for done in range(ticks):
            if stopped():
                return done
            samples += link.frames
            if not link.wait(samples, link.link.patience):
                link.refuse_when_latched()
                raise LinkError(f"no block from the stage within {link.link.patience:g} s")
            graph.tick()
            link.flush()
    return ticks
