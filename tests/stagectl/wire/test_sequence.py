"""Counters: what is lost, and what is late."""

from hypothesis import given
from hypothesis import strategies as st

from stagectl.wire.sequence import Sequence


@given(st.integers(0, 255), st.lists(st.integers(0, 127), max_size=50))
def test_gaps_up_to_half_the_modulus_are_counted(first: int, gaps: list[int]) -> None:
    follow, counter = Sequence(256), first
    assert follow.accept(first) == 0
    for gap in gaps:
        counter = (counter + gap + 1) % 256
        assert follow.accept(counter) == gap


@given(st.integers(0, 255), st.integers(0, 127))
def test_a_frame_that_comes_twice_or_late_changes_nothing(first: int, back: int) -> None:
    follow = Sequence(256)
    follow.accept(first)
    assert follow.accept((first - back) % 256) == -1
    assert follow.accept((first + 1) % 256) == 0


def test_after_a_reset_any_frame_is_the_first() -> None:
    follow = Sequence(256)
    follow.accept(7)
    follow.reset()
    assert follow.accept(100) == 0
