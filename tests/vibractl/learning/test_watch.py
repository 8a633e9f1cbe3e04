import numpy as np
import pytest

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.config import Watch as Settings
from vibractl.learning.law import Law
from vibractl.learning.watch import Trouble, Watch
from vibractl.setup import setup

LIMIT = 0.01


@pytest.fixture(scope="module")
def law() -> Law:
    return setup(linear_config(), linear_matrix()).law


def errors(law: Law, level: float, around: float | None = None, times: float = 1.0) -> np.ndarray:
    """Return an even error, larger by `times` in a band of 20 Hz."""
    lines = np.full(law.reference.shape, level * LIMIT, complex)
    if around is not None:
        lines[np.abs(law.matrix.frequency - around) <= 10] *= times
    return lines


def judged(law: Law, settings: Settings, history: list[np.ndarray], bound: float = 0.2) -> list[Trouble | None]:
    watch = Watch(law, settings, LIMIT)
    drive = np.ones((len(law.reference), 2), complex)
    return [watch.judged(drive, error, np.full(len(error), bound * LIMIT)) for error in history]


def test_a_steady_error_is_no_trouble(law: Law) -> None:
    assert judged(law, Settings(), [errors(law, 0.3)] * 20) == [None] * 20


def test_a_band_that_grows_twice_beyond_its_bound_is_found_below_the_limit(law: Law) -> None:
    history = [errors(law, 0.1), errors(law, 0.1), errors(law, 0.1, 545, 4), errors(law, 0.1, 545, 6)]
    found = judged(law, Settings(), history)
    assert found[:3] == [None] * 3
    assert found[3] is not None
    assert found[3].test == "growth"
    assert abs(found[3].centre - 545) <= 10
    assert found[3].values["grown_db"] > 12


def test_well_below_the_limit_a_band_must_have_grown_in_three_shots(law: Law) -> None:
    """Learning may still find out by itself."""
    grown = [errors(law, 0.01, 545, times) for times in (1, 20, 25, 30)]
    found = judged(law, Settings(), grown, bound=0.02)
    assert found[:3] == [None] * 3
    assert found[3] is not None
    assert found[3].values["grown_db"] > 12


def test_growth_that_was_to_be_expected_is_no_trouble(law: Law) -> None:
    history = [errors(law, 0.1), errors(law, 0.1), errors(law, 0.1, 545, 4), errors(law, 0.1, 545, 6)]
    assert judged(law, Settings(), history, bound=2.0) == [None] * 4


def test_a_line_that_comes_back_above_the_limit_is_found_at_once(law: Law) -> None:
    found = judged(law, Settings(), [errors(law, 5.0), errors(law, 0.1), errors(law, 0.1, 300, 20)], bound=1e9)
    assert found[:2] == [None, None]
    assert found[2] is not None
    assert found[2].test == "level"
    assert abs(found[2].centre - 300) <= 10
    assert found[2].values == {"level_db": pytest.approx(20 * np.log10(2.0), abs=0.02), "drive_db": 0.0}


def test_a_drive_that_grows_is_found_when_it_has_weight(law: Law) -> None:
    watch = Watch(law, Settings(eta_2=1.0, delta=1.0), LIMIT)
    drive, error, bound = (
        np.ones((len(law.reference), 2), complex),
        errors(law, 0.1),
        np.full(len(law.reference), LIMIT),
    )
    assert watch.judged(drive, error, bound) is None
    drive[np.argmin(np.abs(law.matrix.frequency - 400))] = 3.0
    found = watch.judged(drive, 1.01 * error, bound)
    assert found is not None
    assert abs(found.centre - 400) < 0.2 / 2 + 1


def test_outside_of_its_band_nothing_is_looked_at(law: Law) -> None:
    history = [errors(law, 0.1), errors(law, 0.1, 60, 50), errors(law, 0.1, 60, 50)]
    assert judged(law, Settings(), history) == [None] * 3


def test_after_a_band_was_forgiven_it_starts_afresh(law: Law) -> None:
    watch = Watch(law, Settings(), LIMIT)
    drive, bound = np.ones((len(law.reference), 2), complex), np.full(len(law.reference), 0.2 * LIMIT)
    for error in (errors(law, 0.1), errors(law, 0.1, 545, 4), errors(law, 0.1, 545, 6)):
        found = watch.judged(drive, error, bound)
    assert found is not None
    watch.forgive(found.centre)
    assert watch.judged(drive, errors(law, 0.1, 545, 5), bound) is None


@pytest.mark.parametrize(("times", "is_found"), [(1.8, False), (2.2, True)])
def test_a_band_has_grown_when_it_is_twice_as_large_as_it_was_at_its_least(
    law: Law, times: float, is_found: bool
) -> None:
    """Every line grows, so that it matters not where the bands begin; 12 dB is not wanted, and 5 dB is chance."""
    history = [errors(law, 0.3), errors(law, 0.3), *(errors(law, times * 0.3) for _ in range(4))]
    found = [trouble for trouble in judged(law, Settings(), history, bound=0.3) if trouble is not None]
    assert bool(found) is is_found
    assert {trouble.test for trouble in found} <= {"growth"}
    assert all(trouble.values["grown_db"] == pytest.approx(20 * np.log10(times), abs=0.1) for trouble in found)


def test_a_line_is_compared_with_its_least_error_not_with_its_last(law: Law) -> None:
    history = [errors(law, 0.1), errors(law, 0.5), errors(law, 0.5, 300, 4)]
    found = judged(law, Settings(), history, bound=1e9)[-1]
    assert found is not None
    assert found.test == "level"


def test_a_drive_that_is_no_larger_than_its_weight_allows_is_no_trouble(law: Law) -> None:
    """What counts is by how much it is larger, not how large it is."""
    watch = Watch(law, Settings(eta_2=1.0, delta=1.0), LIMIT)
    drive, bound = np.ones((len(law.reference), 2), complex), np.full(len(law.reference), LIMIT)
    assert watch.judged(drive, errors(law, 0.1), bound) is None
    assert watch.judged(1.5 * drive, errors(law, 0.101), bound) is None


def test_far_below_the_limit_growth_is_of_no_concern(law: Law) -> None:
    assert judged(law, Settings(), [errors(law, level) for level in (0.001, 0.01, 0.02, 0.03)], 0.002) == [None] * 4


def test_of_two_bands_that_grow_the_one_that_grew_more_is_told(law: Law) -> None:
    def both(first: float, second: float) -> np.ndarray:
        lines = errors(law, 0.05)
        for centre, level in ((245, first), (545, second)):
            lines[np.abs(law.matrix.frequency - centre) <= 30] *= level
        return lines

    history = [both(8, 3), both(8, 3), *[both(48, 12)] * 4]
    found = next(trouble for trouble in judged(law, Settings(), history) if trouble is not None)
    assert found.test == "growth"
    assert abs(found.centre - 245) <= 30


def test_lines_that_were_dismissed_are_looked_at_no_more_and_all_others_are(law: Law) -> None:
    watch = Watch(law, Settings(), LIMIT)
    drive, bound = np.ones((len(law.reference), 2), complex), np.full(len(law.reference), 0.2 * LIMIT)
    frequency = law.matrix.frequency
    watch.dismiss(np.abs(frequency - 545) <= 40)
    history = [errors(law, 0.1), errors(law, 0.1), errors(law, 0.1, 545, 6), errors(law, 0.1, 545, 6)]
    assert [watch.judged(drive, error, bound) for error in history] == [None] * 4
    first = float(frequency[frequency >= Settings().band[0]][0]) + 8
    grown = errors(law, 0.1, 545, 6)
    grown[np.abs(frequency - first) <= 10] *= 5
    found = [watch.judged(drive, grown, bound) for _ in range(3)][-1]
    assert found is not None
    assert abs(found.centre - first) <= 12
