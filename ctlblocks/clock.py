"""Who calls `tick`: nobody in particular (offline), a timer (paced), or the other end of a wire, where its link is."""

import time
from collections.abc import Callable, Sequence
from threading import Event
from typing import Protocol

from ctlblocks.graph import Graph


class Clock(Protocol):
    """What ticks a graph.  Called again, it goes on where it was."""

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        """Tick a prepared graph `ticks` times, or until `over`, asked now and then, is true; return the ticks run."""


ASKED = 20.0
"""Times a second of a graph's own that it is asked whether it is over."""


class Offline:
    """As fast as it goes."""

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        """Tick a prepared graph `ticks` times, or until `over`; return the ticks run."""
        done, chunk = 0, max(1, round(graph.rate / (graph.frames * ASKED)))
        while done < ticks and not over():
            some = min(chunk, ticks - done)
            self.advance(graph, some)
            done += some
        return done

    def advance(self, graph: Graph, ticks: int) -> None:
        """Tick a prepared graph `ticks` times."""
        run_offline(graph, ticks)


class Paced(Offline):
    """In real time; TimeoutError where the computer falls behind by a second."""

    def advance(self, graph: Graph, ticks: int) -> None:
        """Tick a prepared graph `ticks` times, when each is due."""
        Timer(graph, ()).run(ticks)


def run_offline(graph: Graph, ticks: int, stop: Event | None = None) -> int:
    """Tick a prepared graph `ticks` times, as fast as it goes, or until a thread sets `stop`; return the ticks run."""
    if ticks < 0:
        raise ValueError(f"ticks is {ticks}, must be >= 0")
    stopped, tick = (stop or Event()).is_set, graph.tick
    for done in range(ticks):
        if stopped():
            return done
        tick()
    return ticks


class Timer:
    """Tick a prepared graph in real time: tick n is due n x frames / rate seconds after the first.

    No tick is skipped: behind time, they follow each other without a pause.  However the run ends, the frames named in
    `zeroed` are zero afterwards.  A timer runs once.  Other threads may read how many ticks were `late` (began when the
    next was due already), how late the `worst` was (s), and the `fault` that ended the run.

    Parameters
    ----------
    graph : Graph
    zeroed : sequence of str
        Outputs "block.port" that drive hardware.
    now : callable() -> float, s, a monotonic clock
    sleep : callable(float, s)
    """

    PATIENCE = 1.0
    """Lateness that is a fault, s: the backlog of a suspended machine is never played into the hardware."""

    def __init__(
        self,
        graph: Graph,
        zeroed: Sequence[str],
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.late, self.worst = 0, 0.0
        self.fault: BaseException | None = None
        self._graph, self._outputs = graph, [graph.signal(output) for output in zeroed]
        self._now, self._sleep, self._stop = now, sleep, Event()

    def run(self, ticks: int | None = None) -> None:
        """Tick in the calling thread, `ticks` times, or until `stop` when None; what ends it is raised again."""
        try:
            self._pace(ticks)
        except BaseException as fault:
            self.fault = fault
            raise
        finally:
            self._stop.set()
            for frame in self._outputs:
                frame.fill(0.0)

    def stop(self) -> None:
        """End the run after the current tick, from any thread; a run not begun yet will not begin."""
        self._stop.set()

    def _pace(self, ticks: int | None) -> None:
        period, start, done = self._graph.frames / self._graph.rate, self._now(), 0
        while not self._stop.is_set() and done != ticks:
            due = start + done * period
            if (ahead := due - self._now()) > 0:
                self._sleep(ahead)
            lateness = self._now() - due
            self.worst = max(self.worst, lateness)
            self.late += lateness >= period
            if not lateness <= self.PATIENCE:
                raise TimeoutError(f"tick {done} is {lateness:.3g} s late, must be <= {self.PATIENCE:g} s")
            self._graph.tick()
            done += 1
