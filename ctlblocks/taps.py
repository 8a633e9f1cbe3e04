"""Taps: outputs of a graph that are recorded or shown, by name; their unit and width are those of the port."""

from collections.abc import Sequence
from dataclasses import dataclass

from ctlblocks.block import Block, Port
from ctlblocks.graph import Graph


@dataclass(frozen=True)
class Tap:
    """One output of a graph, under the name by which it is recorded.

    Parameters
    ----------
    name : str
        A Python identifier.
    source : str
        Output "block.port".
    delayed : bool
        Whether it is read a tick late, as whoever in the graph takes it over a delayed wire has it.
    """

    name: str
    source: str
    delayed: bool = False

    def port(self, graph: Graph) -> Port:
        """Return the sink's port for it; KeyError where the graph has no such output."""
        found = graph.port(self.source)
        return Port(self.name, found.unit, found.width)


def attach(graph: Graph, name: str, sink: Block, taps: Sequence[Tap], every: int = 1) -> None:
    """Add a sink to a graph, one of its inputs a tap, of that tap's name; it runs on each `every`-th tick."""
    graph.add(name, sink, every)
    for tap in taps:
        graph.connect(tap.source, f"{name}.{tap.name}", delayed=tap.delayed)
