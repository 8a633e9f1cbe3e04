"""Samples of one milling type: outliers are left out, old ones fade."""

import math

import numpy as np
import pytest

from stagectl.planning.training_set import Memory, TrainingSet


def test_the_newest_samples_count_whole_and_the_oldest_nothing() -> None:
    weights = Memory(window=10, taper=0.5).weights(14)
    np.testing.assert_array_equal(weights[:4], 0.0)
    np.testing.assert_array_equal(weights[-5:], 1.0)
    assert np.all(np.diff(weights[4:9]) > 0.0)
    assert weights[6] == pytest.approx(0.5 + 0.5 * math.cos(math.pi * 0.4))


def test_equal_weights_give_the_plain_mean_and_deviation() -> None:
    known = TrainingSet(Memory())
    for rate, force in ((1.0, 2.0), (2.0, math.nan), (4.0, 5.0)):
        known.add(rate, force)
    assert known.mean() == pytest.approx(7.0 / 3.0)
    assert known.deviation() == pytest.approx(np.std([1.0, 2.0, 4.0], ddof=1))
    assert known.force() == pytest.approx(3.5)
    assert known.count == 3


def test_an_outlier_counts_until_there_are_enough_others() -> None:
    known = TrainingSet(Memory(many=5), [1.0, 1.01, 0.99, 1.0, 9.0], [0.0] * 5)
    assert known.mean() > 2.5
    for rate in (1.0, 1.01, 0.99):
        known.add(rate)
    assert known.mean() == pytest.approx(1.0, abs=0.01)
    assert known.count == 7


def test_a_change_is_taken_over_within_a_window() -> None:
    known = TrainingSet(Memory(window=6, outlier=100.0))
    for rate in [1.0] * 20 + [2.0] * 6:
        known.add(rate)
    assert known.mean() == pytest.approx(2.0)


def test_an_empty_set_has_no_mean() -> None:
    known = TrainingSet(Memory())
    assert known.count == 0
    assert math.isnan(known.mean())
    assert math.isnan(known.force())


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"window": 0}, "window is 0 samples, must be >= 1"),
        ({"taper": math.nan}, "taper is nan, must be 0 to 1"),
        ({"outlier": 1.0}, "outlier is 1.0 standard deviations, must be > 1"),
        ({"many": 1}, "many is 1 samples, must be >= 2"),
    ],
)
def test_a_memory_that_weighs_nothing_is_refused(given: dict[str, float], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Memory(**given)  # type: ignore[arg-type]
