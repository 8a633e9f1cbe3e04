"""What an experiment does now: chosen signals of its graph, seen between ticks, and those of the last seconds."""

from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from ctlblocks import Graph
from ctlblocks.clock import Offline, run_offline
from rigkit.experiment.pace import Pace

LOOKS = 250.0
"""A second of the graph's own time: those of the robot port."""
WINDOW = 10.0
"""s that are kept."""
PACED = 10
"""Ticks at which one that is ticked elsewhere waits for the clock."""


class Watch(Offline):
    """Ticks the graphs of a procedure, one after another, in real time or as fast as it goes, and sees what they do.

    One thread ticks; others may ask at any time.  What is ticked elsewhere is seen by `look` after each tick.

    Parameters
    ----------
    sources : mapping of str to str
        Outputs "block.port" by the names under which they are asked for; what a graph has not is not seen.
    is_paced : bool
    """

    def __init__(self, sources: Mapping[str, str], is_paced: bool) -> None:
        self._sources, self._is_paced = sources, is_paced
        self._graph: Graph | None = None
        self._seen = _Seen({})
        self.pace: Pace | None = None
        """None where it goes as fast as it can, or nothing has been ticked."""

    def advance(self, graph: Graph, ticks: int) -> None:
        """Tick a prepared graph so many times, and look on."""
        self._attend(graph)
        end, every = graph.ticks + ticks, max(1, round(graph.rate / LOOKS))
        while graph.ticks < end:
            run_offline(graph, min(every - graph.ticks % every, end - graph.ticks))
            if graph.ticks % every == 0:
                self._seen.look()
        self._keep_pace(graph)

    def look(self, graph: Graph) -> None:
        """See what a graph of `LOOKS` ticks a second has done in its last tick, and wait until the next is due."""
        self._attend(graph)
        self._seen.look()
        if graph.ticks % PACED == 0:
            self._keep_pace(graph)

    def newest(self, name: str, back: int = 0) -> np.ndarray | None:
        """Return a signal as it was `back` looks ago, shape (width,); None where it is not seen, or not yet."""
        return self._seen.newest(name, back)

    def lately(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return times, shape (looks,), s of the graph, and values, (looks, width), of the last `WINDOW`; copies."""
        return self._seen.lately(name)

    def forget(self) -> None:
        """See nothing until the next graph ticks."""
        self._graph, self._seen = None, _Seen({})

    def _attend(self, graph: Graph) -> None:
        if graph is self._graph:
            return
        signals = {}
        for name, output in self._sources.items():
            with suppress(KeyError):
                signals[name] = graph.signal(output)
        if self._is_paced and self.pace is None:
            self.pace = Pace(graph.rate)
        elif self.pace is not None:
            self.pace.restart()
        self._graph, self._seen = graph, _Seen(signals)

    def _keep_pace(self, graph: Graph) -> None:
        if self.pace is not None:
            self.pace.until(graph.ticks)


class _Seen:
    """Rows of the signals of one graph, the newest `WINDOW` of them."""

    def __init__(self, signals: Mapping[str, np.ndarray]) -> None:
        self._signals, self._count = signals, 0
        rows = round(WINDOW * LOOKS)
        self._rows = {name: np.zeros((rows, signal.shape[1])) for name, signal in signals.items()}

    def look(self) -> None:
        for name, signal in self._signals.items():
            rows = self._rows[name]
            rows[self._count % len(rows)] = signal[-1]
        self._count += 1

    def newest(self, name: str, back: int) -> np.ndarray | None:
        rows, count = self._rows.get(name), self._count
        if rows is None or count <= back:
            return None
        found: np.ndarray = rows[(count - 1 - back) % len(rows)].copy()
        return found

    def lately(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        rows, count = self._rows.get(name), self._count
        if rows is None or count == 0:
            return np.zeros(0), np.zeros((0, 0))
        kept = min(count, len(rows))
        time = np.arange(count - kept + 1, count + 1) / LOOKS
        return time, rows[:count].copy() if count <= len(rows) else np.roll(rows, -(count % len(rows)), axis=0)
