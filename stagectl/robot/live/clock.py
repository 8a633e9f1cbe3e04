"""The clock of a trial's graph behind the wires: the robot's reports, several ticks for each."""

from collections.abc import Callable

from ctlblocks import Graph
from stagectl.link.bus import LinkError
from stagectl.robot.live.wires import LiveWires
from stagectl.wire.robot import RATE


class ReportClock:
    """Ticks a graph `every` times a report of the robot; when it is silent, as time goes, so that this is judged.

    The first tick is that of the first report after `LiveWires.begin`.  Each lost report has its ticks, too: what the
    graph counts is the robot's time.

    Parameters
    ----------
    wires : LiveWires
    every : int
        Ticks a report.
    """

    def __init__(self, wires: LiveWires, every: int) -> None:
        self._wires, self._every, self._due = wires, every, 0

    def __call__(self, graph: Graph, ticks: int) -> None:
        """Tick so many times.

        Raises
        ------
        LinkError : the robot cannot be led, before the first tick.
        """
        for _ in range(ticks):
            if graph.ticks % self._every:
                graph.tick()
                continue
            if graph.ticks == 0:
                self._begin(graph)
            self._due += 1
            self._wait()
            graph.tick()
            self._wires.port.flush()

    def run(self, graph: Graph, ticks: int, over: Callable[[], bool]) -> int:
        """Tick so many times, or until `over`, asked before each report; return the ticks run.

        Raises
        ------
        LinkError : as of a call.
        """
        for done in range(ticks):
            if graph.ticks % self._every == 0 and over():
                return done
            self(graph, 1)
        return ticks

    def _begin(self, graph: Graph) -> None:
        if graph.rate != self._every * RATE:
            raise LinkError(f"the graph ticks at {graph.rate:g} 1/s, must be at {self._every * RATE:g}")
        self._due = 0
        self._wires.begin()

    def _wait(self) -> None:
        port, wires, due = self._wires.port, self._wires, self._due
        if port.reason:
            port.until(lambda: wires.reports >= due, 1.0 / RATE)
        else:
            port.until(lambda: wires.reports >= due or bool(port.reason), port.patience)
