"""Blocks of a few lines, and a graph of them, for the tests of graphs."""

import numpy as np

from ctlblocks import Block, Graph, Port


class Count(Block):
    """Emit the number of its calls."""

    outputs = (Port("count"),)

    def prepare(self, rate: float, frames: int) -> None:
        self.rate, self.frames, self.calls = rate, frames, 0

    def process(self, count: np.ndarray) -> None:
        self.calls += 1
        count.fill(self.calls)


class Pair(Block):
    """Emit 10 x first + second, both inputs from anywhere."""

    inputs = (Port("first"), Port("second"))
    outputs = (Port("both"),)

    def process(self, first: np.ndarray, second: np.ndarray, both: np.ndarray) -> None:
        both[:] = 10.0 * first + second


class Pass(Block):
    """Emit what comes in, and remember it."""

    inputs = (Port("signal"),)
    outputs = (Port("same"),)

    def __init__(self) -> None:
        self.seen: list[float] = []

    def process(self, signal: np.ndarray, same: np.ndarray) -> None:
        same[:] = signal
        self.seen.append(float(signal[-1, 0]))


class Last(Block):
    """An output for the clock alone."""

    inputs = (Port("request", "V", 2),)
    outputs = (Port("output", "V", 2, last=True),)

    def process(self, request: np.ndarray, output: np.ndarray) -> None:
        output[:] = request


def graph_of(*, frames: int = 1, **blocks: Block) -> Graph:
    graph = Graph(1000.0, frames)
    for name, block in blocks.items():
        graph.add(name, block)
    return graph


def values(graph: Graph, output: str, ticks: int) -> list[float]:
    found = []
    for _ in range(ticks):
        graph.tick()
        found.append(float(graph.signal(output)[-1, 0]))
    return found
