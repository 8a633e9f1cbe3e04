"""The planner in a graph: finished segments in, next segments out."""

import numpy as np
import pytest

from stagectl.planning.milling import mill
from stagectl.planning.pocket import check, planner, untrained
from stagectl.planning.problem import Pocket
from stagectl.planning.segments import Segments
from tests.stagectl.planning.pockets import EXAMPLE

POCKET = Pocket.from_dict(EXAMPLE)


class _Tick:
    """A block's signals, a sample a call."""

    def __init__(self, block: Segments) -> None:
        self.block = block
        block.prepare(250.0, 1)
        self.inputs = [np.zeros((1, port.width)) for port in block.inputs]
        self.outputs = [np.zeros((1, port.width)) for port in block.outputs]
        self.tell(0.0, 0.0, 0.0)

    def tell(self, *values: float) -> None:
        for signal, value in zip(self.inputs, values, strict=True):
            signal[:] = value
        self.block.process(*self.inputs, *self.outputs)
        self.block.advance()
        self.inputs[0][:] = 0.0
        self.block.process(*self.inputs, *self.outputs)

    @property
    def number(self) -> int:
        return int(self.outputs[0][0, 0])


def test_segment_by_segment_a_block_mills_what_the_planner_would() -> None:
    expected = [each for _ in range(2) for each in mill(POCKET, planner("exact", POCKET))]
    tick = _Tick(Segments(POCKET, lambda: planner("exact", POCKET), pockets=2))
    for number, each in enumerate(expected, start=1):
        assert tick.number == number
        np.testing.assert_array_equal(tick.outputs[1][0], [each.row, each.col])
        assert tick.outputs[3][0, 0] == each.is_lifted
        tick.tell(1.0, each.duration, 1.5)
    assert tick.number == 0
    assert tick.block.done[0].force_deviation == 1.5
    assert check(POCKET, [each.in_path for each in tick.block.done[: len(expected) // 2]]).complete


def test_the_first_segment_ends_at_the_wall_across() -> None:
    tick = _Tick(Segments(POCKET, lambda: planner("exact", POCKET)))
    np.testing.assert_array_equal(tick.outputs[1][0], [27, 0])
    np.testing.assert_array_equal(tick.outputs[2][0], [27, 27])


def test_it_learns_over_pockets_from_what_is_measured() -> None:
    tick = _Tick(Segments(POCKET, lambda: untrained("sequential", POCKET), pockets=3))
    expected = untrained("sequential", POCKET)
    for each in [each for _ in range(3) for each in mill(POCKET, expected)]:
        np.testing.assert_array_equal(tick.outputs[1][0], [each.row, each.col])
        tick.tell(1.0, each.duration, np.nan)
    assert tick.number == 0


def test_nothing_happens_until_a_segment_is_finished() -> None:
    tick = _Tick(Segments(POCKET, lambda: planner("exact", POCKET)))
    for _ in range(5):
        tick.tell(0.0, 3.0, 1.0)
    assert tick.number == 1
    assert tick.block.done == []


def test_a_segment_that_ends_before_the_planner_was_asked_is_counted() -> None:
    block = Segments(POCKET, lambda: planner("exact", POCKET))
    tick = _Tick(block)
    tick.inputs[0][:] = 1.0
    block.process(*tick.inputs, *tick.outputs)
    block.process(*tick.inputs, *tick.outputs)
    assert block.missed == 1


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), float("inf")])
def test_a_duration_that_is_none_is_refused_and_the_segment_stands(duration: float) -> None:
    tick = _Tick(Segments(POCKET, lambda: planner("exact", POCKET)))
    with pytest.raises(ValueError, match=r"segment 1: duration is .* s, must be > 0"):
        tick.tell(1.0, duration, 0.0)
    assert tick.number == 1
    assert tick.block.done == []
    tick.tell(1.0, 2.25, 0.0)
    assert tick.number == 2


def test_no_pocket_is_refused() -> None:
    with pytest.raises(ValueError, match="pockets is 0, must be >= 1"):
        Segments(POCKET, lambda: planner("exact", POCKET), pockets=0)
