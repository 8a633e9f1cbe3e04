"""The graph: what it refuses, in which order it runs, what a delayed wire and a slower block read."""

import threading
from collections.abc import Callable

import numpy as np
import pytest

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


# what is refused


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
    graph.add("c", Count())
    with pytest.raises(RuntimeError, match="not prepared"):
        graph.tick()


def test_a_graph_whose_preparation_failed_does_not_tick() -> None:
    class Broken(Count):
        def prepare(self, rate: float, frames: int) -> None:
            raise ValueError("rate is too low")

    graph = graph_of(a=Broken())
    with pytest.raises(ValueError, match="rate is too low"):
        graph.prepare()
    with pytest.raises(RuntimeError, match="not prepared"):
        graph.tick()


# order and delay


def test_blocks_run_in_the_order_of_their_wires_not_of_their_names() -> None:
    graph = graph_of(end=Pass(), middle=Pass(), start=Count())
    graph.connect("start.count", "middle.signal")
    graph.connect("middle.same", "end.signal")
    graph.prepare()
    assert values(graph, "end.same", 3) == [1, 2, 3]


def test_a_delayed_wire_reads_the_tick_before_and_zero_at_first() -> None:
    graph = graph_of(a=Count(), b=Pass())
    graph.connect("a.count", "b.signal", delayed=True)
    graph.prepare()
    assert values(graph, "b.same", 4) == [0, 1, 2, 3]


def test_a_delayed_wire_beside_a_direct_one_between_the_same_blocks() -> None:
    graph = graph_of(a=Count(), b=Pair())
    graph.connect("a.count", "b.first")
    graph.connect("a.count", "b.second", delayed=True)
    graph.prepare()
    assert values(graph, "b.both", 3) == [10, 21, 32]


def test_two_blocks_that_read_each_other_delayed() -> None:
    graph = graph_of(a=Pair(), b=Pair(), one=Count())
    graph.connect("one.count", "a.first")
    graph.connect("b.both", "a.second", delayed=True)
    graph.connect("one.count", "b.first")
    graph.connect("a.both", "b.second", delayed=True)
    graph.prepare()
    assert values(graph, "a.both", 3) == [10, 30, 60]
    assert values(graph, "b.both", 1) == [100]


def test_a_block_reads_its_own_last_output_untouched_while_it_writes_the_next() -> None:
    class Careless(Pair):
        def process(self, first: np.ndarray, second: np.ndarray, both: np.ndarray) -> None:
            both.fill(-1.0)
            both[:] = first + second

    graph = graph_of(a=Count(), sum=Careless())
    graph.connect("a.count", "sum.first")
    graph.connect("sum.both", "sum.second", delayed=True)
    graph.prepare()
    assert values(graph, "sum.both", 4) == [1, 3, 6, 10]


def test_a_slower_block_runs_each_nth_tick_at_its_own_rate_and_holds() -> None:
    slow, after = Count(), Pass()
    graph = graph_of(after=after)
    graph.add("slow", slow, every=3)
    graph.connect("slow.count", "after.signal")
    graph.prepare()
    assert (slow.rate, slow.frames) == (pytest.approx(1000.0 / 3), 1)
    assert values(graph, "after.same", 7) == [1, 1, 1, 2, 2, 2, 3]


def test_a_delayed_wire_from_a_slower_block_reads_what_it_held_a_tick_ago() -> None:
    graph = graph_of(after=Pass())
    graph.add("slow", Count(), every=2)
    graph.connect("slow.count", "after.signal", delayed=True)
    graph.prepare()
    assert values(graph, "after.same", 6) == [0, 1, 1, 2, 2, 3]


def test_a_slower_block_reads_a_delayed_wire_one_tick_ago_not_one_call_ago() -> None:
    slow = Pass()
    graph = graph_of(fast=Count())
    graph.add("slow", slow, every=3)
    graph.connect("fast.count", "slow.signal", delayed=True)
    graph.prepare()
    values(graph, "slow.same", 7)
    assert slow.seen == [0, 3, 6]


def test_two_slower_blocks_meet_at_their_common_tick() -> None:
    two, three = Count(), Count()
    graph = Graph(1000.0)
    graph.add("two", two, every=2)
    graph.add("three", three, every=3)
    graph.prepare()
    for _ in range(13):
        graph.tick()
    assert (two.calls, three.calls) == (7, 5)


def test_a_slower_block_in_a_graph_of_longer_frames_is_refused() -> None:
    with pytest.raises(ValueError, match="slow: every is 2, must be >= 1, and 1 in a graph of more than one frame"):
        Graph(1000.0, 2).add("slow", Count(), every=2)


def test_rates_that_repeat_too_late_are_refused_with_the_number() -> None:
    graph = Graph(1000.0)
    for name, every in (("a", 97), ("b", 89), ("c", 2)):
        graph.add(name, Count(), every=every)
    with pytest.raises(ValueError, match="repeat after 17266 ticks, must be <= 10000"):
        graph.prepare()


# preparing, changing, reading


def test_prepare_again_starts_over() -> None:
    graph = graph_of(a=Count(), b=Pass())
    graph.connect("a.count", "b.signal", delayed=True)
    graph.prepare()
    first = values(graph, "b.same", 3)
    graph.prepare()
    assert graph.ticks == 0
    assert graph.signal("a.count")[0, 0] == 0.0
    assert values(graph, "b.same", 3) == first


def test_a_change_runs_between_ticks_and_one_it_queues_waits_for_the_next() -> None:
    block = Count()
    graph = graph_of(a=block)
    graph.prepare()

    def jump() -> None:
        block.calls = 100
        graph.changes.append(jump)

    assert values(graph, "a.count", 2) == [1, 2]
    graph.changes.append(jump)
    assert values(graph, "a.count", 2) == [101, 101]


def test_changes_from_another_thread_all_arrive() -> None:
    graph, arrived = graph_of(a=Count()), []
    graph.prepare()
    thread = threading.Thread(target=lambda: [graph.changes.append(lambda n=n: arrived.append(n)) for n in range(1000)])
    thread.start()
    while thread.is_alive():
        graph.tick()
    thread.join()
    graph.tick()
    assert arrived == list(range(1000))


def test_a_fault_in_a_block_leaves_the_tick_and_the_graph_can_be_prepared_again() -> None:
    class Fails(Count):
        def process(self, count: np.ndarray) -> None:
            super().process(count)
            if self.calls == 2:
                raise RuntimeError("sensor is gone")

    graph = graph_of(a=Fails())
    graph.prepare()
    graph.tick()
    with pytest.raises(RuntimeError, match="sensor is gone"):
        graph.tick()
    graph.prepare()
    graph.tick()


def test_a_clock_writes_a_source_and_reads_the_last_output_through_live_frames() -> None:
    class Source(Block):
        outputs = (Port("drive", "V", 2),)

        def process(self, drive: np.ndarray) -> None:
            """Leave what the clock has written."""

    graph = graph_of(frames=4, source=Source(), last=Last())
    graph.connect("source.drive", "last.request")
    graph.prepare()
    graph.signal("source.drive")[:] = np.arange(8.0).reshape(4, 2)
    graph.tick()
    assert np.array_equal(graph.signal("last.output"), np.arange(8.0).reshape(4, 2))


def test_reading_an_output_that_is_not_there_is_refused() -> None:
    with pytest.raises(KeyError, match="a has no port 'x' among its outputs"):
        graph_of(a=Count()).signal("a.x")
