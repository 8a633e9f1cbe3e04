"""Back to the best shot: when, to which, and how much slower then."""

import numpy as np
import pytest

from vibractl.learning.rollback import Best, Rollback

NOTHING = 0.0
"""m/s^2 s: an error that was not expected at all."""


def judged(back: Rollback, sizes: list[float], expected: float = NOTHING, first: int = 0) -> list[Best | None]:
    """Let it see errors of these sizes, from drives that are the shot's number."""
    return [
        back.judged(first + shot, np.full((3, 2), first + shot + 0j), np.full((4, 1), size / 2 + 0j), expected)
        for shot, size in enumerate(sizes)
    ]


def test_it_goes_back_to_the_best_drive_when_the_error_has_grown_twice_and_is_four_times_the_least() -> None:
    *before, best = judged(Rollback(), [8.0, 2.0, 5.0, 9.0])
    assert before == [None, None, None]
    assert best is not None
    assert best.shot == 1
    np.testing.assert_array_equal(best.lines, 1.0)
    assert best.growth_db == pytest.approx(20 * np.log10(4.5))


@pytest.mark.parametrize(
    "sizes",
    [
        [4.0, 1.0, 5.0],
        [4.0, 1.0, 2.5, 3.9],
        [4.0, 1.0, 5.0, 4.0, 5.0, 4.0],
        [4.0, 3.0, 2.0, 1.0, 1.0, 1.0],
    ],
    ids=["once", "by less than four times", "not in a row", "not at all"],
)
def test_it_stays_where_the_error_has_not_grown_so(sizes: list[float]) -> None:
    back = Rollback()
    assert judged(back, sizes) == [None] * len(sizes)
    assert back.pace == 1.0


def test_growth_that_was_to_be_expected_is_no_reason() -> None:
    assert judged(Rollback(), [4.0, 1.0, 2.5, 4.5, 6.5], expected=10.0) == [None] * 5


def test_every_rollback_halves_the_pace_and_two_more_shots_must_have_grown_before_the_next() -> None:
    back = Rollback()
    sizes = [1.0, 3.0, 5.0, 4.9, 5.5, 6.0]
    assert [best is not None for best in judged(back, sizes)] == [False, False, True, False, False, True]
    assert back.pace == 0.25


def test_a_better_shot_becomes_the_one_to_go_back_to() -> None:
    back = Rollback()
    judged(back, [1.0, 3.0, 5.0])
    best = judged(back, [0.5, 1.2, 2.2], first=3)[-1]
    assert best is not None
    assert best.shot == 3


def test_the_drive_it_keeps_is_its_own() -> None:
    back, lines = Rollback(), np.ones((3, 2), complex)
    back.judged(0, lines, np.ones((4, 1), complex), NOTHING)
    lines[:] = 7.0
    best = judged(back, [4.0, 8.0], first=1)[-1]
    assert best is not None
    np.testing.assert_array_equal(best.lines, 1.0)


def test_what_is_forgotten_is_not_gone_back_to() -> None:
    back = Rollback()
    judged(back, [1.0, 2.5])
    back.forget()
    assert judged(back, [5.0, 6.0, 19.0], first=2) == [None] * 3
    best = judged(back, [21.0], first=5)[-1]
    assert best is not None
    assert best.shot == 2


def test_bounds_that_have_widened_because_the_error_grew_excuse_nothing() -> None:
    back, bounds = Rollback(), [5.0, 1.2, 100.0, 100.0]
    best = [
        back.judged(shot, np.ones((3, 2), complex), np.full((4, 1), size / 2 + 0j), bound)
        for shot, (size, bound) in enumerate(zip([4.0, 1.0, 2.5, 4.5], bounds, strict=True))
    ]
    assert [each is not None for each in best] == [False, False, False, True]


def test_a_drive_of_long_ago_is_not_gone_back_to() -> None:
    """The vibrator drifts: what was best then leaves more now than growth by some per cent a shot."""
    slowly = [1.0 * 1.1**shot for shot in range(30)]
    assert judged(Rollback(), slowly) == [None] * 30
