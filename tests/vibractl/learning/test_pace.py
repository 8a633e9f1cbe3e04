"""That learning slows down where it has made the error larger, and nowhere else."""

import numpy as np

from tests.vibractl.learning.line_plant import FREQUENCY, LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.pace import FASTER, SLOWER, SLOWEST, Pace

NOISE = np.full(4, 0.1)


def test_only_a_line_whose_error_has_grown_beyond_noise_is_slowed() -> None:
    pace = Pace(4)
    pace.take(np.array([1.0, 1.0, 1.0, 1.0]), NOISE)
    np.testing.assert_array_equal(pace.part, 1.0)
    pace.take(np.array([2.0, 1.05, 1.0, 0.5]), NOISE)
    np.testing.assert_allclose(pace.part, [SLOWER, 1, 1, 1])


def test_it_comes_back_by_and_by_and_a_line_is_never_given_up() -> None:
    pace, power = Pace(1), 1.0
    for _ in range(20):
        power *= 2
        pace.take(np.array([power]), np.zeros(1))
    assert pace.part[0] == SLOWEST
    pace.take(np.array([power]), np.zeros(1))
    np.testing.assert_allclose(pace.part, FASTER * SLOWEST)
    for _ in range(60):
        pace.take(np.array([power]), np.zeros(1))
    assert pace.part[0] == 1.0


def test_an_error_that_learning_cannot_have_made_grow_slows_nothing() -> None:
    pace = Pace(2)
    for power in (1.0, 2.0):
        pace.take(np.array([power, power]), np.zeros(2), is_doubtful=np.array([True, False]))
    np.testing.assert_allclose(pace.part, [SLOWER, 1.0])


def test_an_error_that_has_grown_by_what_the_plant_drifts_slows_nothing() -> None:
    """From 1 to 1.3, as amplitudes: a drift of 0.3 explains it, one of 0.2 does not."""
    pace = Pace(2)
    for size in (1.0, 1.3):
        pace.take(np.full(2, size**2), np.zeros(2), np.array([0.3, 0.2]) ** 2)
    np.testing.assert_allclose(pace.part, [1.0, SLOWER])


def test_another_level_begins_anew() -> None:
    pace = Pace(1)
    for power in (1.0, 2.0):
        pace.take(np.array([power]), np.zeros(1))
    pace.forget()
    assert pace.part[0] == 1.0
    pace.take(np.array([9.0]), np.zeros(1))
    assert pace.part[0] == 1.0


def test_where_a_model_drives_the_wrong_way_lines_end_no_louder_and_the_others_are_learned() -> None:
    """G of 60 to 64 Hz is turned by 100 degrees, and the run does not correct its model."""
    true = modal(2, 2)
    turned = (FREQUENCY >= 60) & (FREQUENCY <= 64)
    law = law_of(matrix_of(true * np.where(turned, np.exp(1j * np.deg2rad(100)), 1.0)[:, None, None]))
    turned = (law.matrix.frequency >= 60) & (law.matrix.frequency <= 64)
    right = (law.matrix.frequency >= 42) & (law.matrix.frequency <= 50)
    left = {}
    for cautious in (False, True):
        algorithm = Algorithm(law, Adaptation(model=False, cautious=cautious, rollback=False), Watch(), -40.0)
        plant = LinePlant(true, law)
        sizes = []
        for _ in range(12):
            shot = plant.shot(algorithm.lines)
            error = np.linalg.norm(law.reference - shot.response, axis=1)
            sizes.append([np.linalg.norm(error[band]) for band in (turned, right)])
            algorithm.step(shot)
        left[cautious] = np.array(sizes)
    assert left[False][-1, 0] > 10 * left[False][0, 0]
    assert left[True][-1, 0] < 3 * left[True][0, 0]
    assert left[True][-1, 1] < 0.05 * np.linalg.norm(law.reference[right])


def test_a_plant_that_drifts_is_followed_where_its_model_is_right() -> None:
    """G grows by 0.2 % a shot, over eighty shots; what is left is no more than a few shots of that."""
    true = modal(2, 2)
    law = law_of(matrix_of(true))
    algorithm, left = Algorithm(law, Adaptation(rollback=False), Watch(), -40.0), []
    for number in range(80):
        shot = LinePlant(true * 1.002**number, law).shot(algorithm.lines)
        left.append(float(np.linalg.norm(law.reference - shot.response) / np.linalg.norm(law.reference)))
        algorithm.step(shot)
    assert max(left[30:]) < 0.005
