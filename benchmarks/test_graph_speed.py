"""The graph under pytest-benchmark: its own cost, ten gains, and the same ten in GNU Radio."""

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from benchmarks import graph

COST = 0.05
"""What a graph may add to a block's call, us."""


def test_the_graph_adds_little_to_a_call(benchmark: BenchmarkFixture, capsys: pytest.CaptureFixture[str]) -> None:
    cost, call = benchmark.pedantic(graph.own_cost)
    with capsys.disabled():
        print(f"\na graph's own cost: {cost:.3f} us a block call, beside {call:.3f} us of a call that does nothing")
    assert cost <= COST


def test_a_tick_of_ten_gains(benchmark: BenchmarkFixture) -> None:
    benchmark(graph.ten_gains().tick)


def test_a_call_of_one_gain(benchmark: BenchmarkFixture) -> None:
    gains = graph.ten_gains()
    benchmark(graph.Gain(2.0).process, gains.signal("b0.signal"), gains.signal("b1.scaled"))


@pytest.mark.parametrize("buffer", graph.BUFFERS)
def test_ten_gains_beside_gnu_radio(
    buffer: int, benchmark: BenchmarkFixture, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        runs = benchmark.pedantic(graph.beside_gnu_radio, (buffer,))
    except RuntimeError as reason:
        with capsys.disabled():
            print(f"\nGNU Radio skipped: {reason}")
        pytest.skip(str(reason))
    with capsys.disabled():
        print(f"\n{graph.comparison(buffer, *runs)}")
