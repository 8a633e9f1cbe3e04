"""What a graph refuses, by name: blocks, ports, wires, loops and ticks."""

from collections.abc import Callable

import numpy as np
import pytest

from ctlblocks import Graph, Port
from tests.ctlblocks.small_blocks import Count, Last, Pair, Pass, graph_of


@pytest.mark.parametrize(("rate", "frames"), [(0.0, 1), (-1.0, 1), (float("nan"), 1), (float("inf"), 1), (1.0, 0)])
def test_a_rate_or_frame_that_is_none_is_refused_with_its_value(rate: float, frames: int) -> None:
    with pytest.raises(ValueError, match=f"rate is {rate} samples/s, must be .*; frames is {frames}, must be >= 1"):
        Graph(rate, frames)


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (lambda g: g.add("a.b", Count()), "block name 'a.b' is not a Python identifier"),
        (lambda g: g.add("a", Count()), "block 'a' is in the graph already"),
        (lambda g: g.add("c", Count(), every=0), "c: every is 0, must be >= 1"),
        (lambda g: g.connect("a.count", "b.first"), "b.first is wired already, to a.count, not to a.count"),
        (lambda g: g.connect("last.output", "last.request"), "last.output is the last output before the device"),
    ],
)
def test_a_wrong_name_number_or_wire_is_refused_with_its_name(refused: Callable[[Graph], None], message: str) -> None:
    graph = graph_of(a=Count(), b=Pair(), last=Last())
    graph.connect("a.count", "b.first")
    with pytest.raises(ValueError, match=message):
        refused(graph)


def test_one_block_under_two_names_is_refused_by_both() -> None:
    block = Count()
    graph = graph_of(a=block)
    with pytest.raises(ValueError, match="b is the same block as a"):
        graph.add("b", block)


def test_a_block_whose_arguments_are_not_its_ports_is_refused() -> None:
    class Swapped(Pair):
        def process(self, second: np.ndarray, first: np.ndarray, both: np.ndarray) -> None:
            both[:] = first + second

    with pytest.raises(TypeError, match=r"Swapped.process takes \(second, first, both\), must take its ports"):
        graph_of(pair=Swapped())


@pytest.mark.parametrize(
    ("source", "target", "message"),
    [
        ("x.count", "b.first", r"no block 'x' for 'x.count'; there are \['a', 'b'\]"),
        ("a", "b.first", r"a has no port '' among its outputs; there are \['count'\]"),
        ("a.number", "b.first", r"a has no port 'number' among its outputs; there are \['count'\]"),
        ("a.count", "b.third", r"b has no port 'third' among its inputs; there are \['first', 'second'\]"),
        ("b.first", "b.second", "b has no port 'first' among its outputs"),
    ],
)
def test_an_unknown_port_is_refused_with_what_there_is(source: str, target: str, message: str) -> None:
    with pytest.raises(KeyError, match=message):
        graph_of(a=Count(), b=Pair()).connect(source, target)


@pytest.mark.parametrize("port", [Port("count", "V"), Port("count", "1", 2)])
def test_another_unit_or_width_is_refused_with_both(port: Port) -> None:
    source = Count()
    source.outputs = (port,)
    with pytest.raises(TypeError, match=f"a.count is {port.width} x {port.unit}, b.first must be too: is 1 x 1"):
        graph_of(a=source, b=Pair()).connect("a.count", "b.first")


def test_an_input_that_is_not_wired_is_refused_by_name() -> None:
    graph = graph_of(a=Count(), b=Pair())
    graph.connect("a.count", "b.second")
    with pytest.raises(ValueError, match="b: input first is not wired"):
        graph.prepare()


def test_a_graph_without_a_block_is_refused() -> None:
    with pytest.raises(ValueError, match="no block"):
        Graph(1.0).prepare()


def test_a_loop_without_a_delay_is_refused_by_name() -> None:
    graph = graph_of(a=Pass(), b=Pass(), outside=Pass())
    graph.connect("a.same", "b.signal")
    graph.connect("b.same", "a.signal")
    graph.connect("b.same", "outside.signal")
    with pytest.raises(
        ValueError, match=r"wait for each other: (a -> b -> a|b -> a -> b); make one .* delayed"
    ) as refused:
        graph.prepare()
    assert "outside" not in str(refused.value)


def test_a_tick_before_prepare_or_after_a_new_wire_is_refused() -> None:
    graph = graph_of(a=Count(), b=Pass())
    with pytest.raises(RuntimeError, match=r"not prepared: call prepare\(\)"):
        graph.tick()
    graph.connect("a.count", "b.signal")
    graph.prepare()
    graph.tick()
    graph.add("c", Pass())
    with pytest.raises(RuntimeError, match="not prepared"):
        graph.tick()
    with pytest.raises(ValueError, match="c: input signal is not wired"):
        graph.prepare()
    graph.connect("b.same", "c.signal")
    graph.prepare()
    graph.add("d", Pair())
    graph.connect("c.same", "d.first")
    graph.connect("c.same", "d.second")
    graph.prepare()
    graph.tick()


def test_a_wire_that_would_change_a_prepared_graph_wants_it_prepared_again() -> None:
    class Loose(Pass):
        inputs = ()

        def process(self, *signals: np.ndarray) -> None:
            signals[-1].fill(7.0)

    loose = Loose()
    graph = graph_of(a=Count(), b=loose)
    graph.prepare()
    loose.inputs = (Port("signal"),)
    graph.connect("a.count", "b.signal")
    with pytest.raises(RuntimeError, match="not prepared"):
        graph.tick()


def test_a_graph_whose_preparation_failed_does_not_tick() -> None:
    class Broken(Count):
        preparations = 0

        def prepare(self, rate: float, frames: int) -> None:
            super().prepare(rate, frames)
            self.preparations += 1
            if self.preparations == 2:
                raise ValueError("rate is too low")

    graph = graph_of(a=Broken())
    graph.prepare()
    with pytest.raises(ValueError, match="rate is too low"):
        graph.prepare()
    with pytest.raises(RuntimeError, match="not prepared"):
        graph.tick()
