"""In which order a graph runs, what a delayed wire and a slower block read, and what happens between ticks."""

import threading

import numpy as np
import pytest

from ctlblocks import Block, Graph, Port
from tests.ctlblocks.small_blocks import Count, Last, Pair, Pass, graph_of, values


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


def test_what_was_rehearsed_is_forgotten_and_waits_to_be_prepared() -> None:
    graph = graph_of(a=Count(), b=Count())
    once, slow = Pass(), Pass()
    graph.add("once", once)
    graph.add("slow", slow, every=4)
    graph.connect("a.count", "once.signal")
    graph.connect("b.count", "slow.signal", delayed=True)
    graph.rehearse()
    assert (once.seen, slow.seen) == ([1, 2], [0, 1])
    with pytest.raises(RuntimeError, match="not prepared"):
        graph.tick()
    graph.prepare()
    assert values(graph, "once.same", 3) == [1, 2, 3]
    assert graph.ticks == 3
