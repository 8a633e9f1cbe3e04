"""The clock of a graph behind a wire: the other end's own crystal, a tick for each block or report that comes."""

from collections.abc import Callable
from typing import Protocol

from ctlblocks.graph import Graph
from rigkit.priority import real_time
from stagectl.link.bus import LinkError


class Pacemaker(Protocol):
    """What the other end sends in time: the stage's blocks of samples, the robot's reports."""

    @property
    def beat(self) -> str:
        """What comes, in words."""

    @property
    def rate(self) -> float:
        """Samples/s of the wire."""

    @property
    def frames(self) -> int:
        """Samples that come at once."""

    @property
    def patience(self) -> float:
        """Longest time without a beat, s."""

    def skip(self) -> int:
        """Pass over what waits; return how many samples have come in all."""

    def wait(self, samples: int, seconds: float) -> bool:
        """Return True as soon as so many samples have come in all, False on a fault or after `seconds`."""

    def refuse_when_latched(self) -> None:
        """Raise while a fault is latched."""

    def flush(self) -> None:
        """Have what waits to be sent sent now."""


class Linked:
    """Ticks a prepared graph once for each beat of a link.  Called again, it goes on with the next beat.

    Two beats that come at once make two ticks without a pause; none is left out.

    Parameters
    ----------
    link : StageLink or RobotPort, open
    """

    def __init__(self, link: Pacemaker) -> None:
        self._link = link
        self._samples: int | None = None

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        """Tick a graph `ticks` times, or until `over`, asked before each; return the ticks run.

        Parameters
        ----------
        graph : Graph, of the link's rate and frames
        ticks : int
        over : callable() -> bool

        Raises
        ------
        ValueError : the graph's frames or its rate are not the link's.
        LinkFault, RobotFault : a fault has latched.
        LinkError : no beat has come for `link.patience`.
        """
        link = self._link
        if (graph.frames, graph.rate) != (link.frames, link.rate):
            raise ValueError(
                f"the graph ticks by {graph.frames} frames at {graph.rate:g} samples/s, must be {link.frames} at "
                f"{link.rate:g} as on the wire"
            )
        with real_time():
            samples = link.skip() if self._samples is None else self._samples
            for done in range(ticks):
                self._samples = samples
                if over():
                    return done
                samples += link.frames
                if not link.wait(samples, link.patience):
                    link.refuse_when_latched()
                    raise LinkError(f"no {link.beat} within {link.patience:g} s")
                graph.tick()
                link.flush()
            self._samples = samples
        return ticks


def run_linked(graph: Graph, link: Pacemaker, ticks: int, stopped: Callable[[], bool] = lambda: False) -> int:
    """Tick a prepared graph once for each beat of a link from now on, as `Linked` does."""
    return Linked(link).run(graph, ticks, stopped)
