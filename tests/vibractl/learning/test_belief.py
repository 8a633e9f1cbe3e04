"""What is believed of the vibrator: the model where nothing is followed, else what shots show."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import FREQUENCY, LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation
from vibractl.learning.belief import REACH, Belief
from vibractl.learning.law import Law, bounded_inverse
from vibractl.learning.shot import Shot
from vibractl.learning.update import update

TRUE = modal(2, 2)
STILL = Adaptation(model=False, doubt=0.0)


def missed(belief: Belief, before: Shot, after: Shot) -> float:
    """Return what G does not explain of a change of response, relative."""
    change = after.response - before.response
    return float(np.linalg.norm(change - belief.explained(after.drive - before.drive)) / np.linalg.norm(change))


def two_shots(law: Law, plant: LinePlant) -> tuple[Shot, Shot]:
    """Return shots of the first drive and of one that is a third larger and turned."""
    return plant.shot(law.start), plant.shot(1.3 * np.exp(0.4j) * law.start)


def test_a_drive_lets_go_where_g_is_too_weak_to_be_driven_and_counts_least() -> None:
    """Shot after shot of the same error, the drive of the weak line ends; that of the strong ones goes on."""
    matrix = matrix_of(np.where(FREQUENCY == 60, 1e-3, 1.0 + 0j)[:, None, None])
    plain = law_of(matrix)
    lines = plain.matrix.frequency
    law = replace(plain, importance=np.where(lines >= 100, 100.0, 1.0))
    belief, gain = Belief(law, Adaptation(stretch=False)), np.full(len(lines), 0.8)
    drive, error, sizes = np.zeros((len(lines), 1), complex), np.full((len(lines), 1), 1e-3 + 0j), []
    for _ in range(40):
        drive = belief.next_drive(drive, error, gain, law.active)
        sizes.append(np.abs(drive[np.isin(lines, [60, 80]), 0]))
    assert sizes[-1][0] < 1.05 * sizes[10][0]
    assert sizes[-1][1] > 2.5 * sizes[10][1]


def test_a_model_that_is_not_followed_stays_and_asks_for_the_update_of_the_thesis() -> None:
    law = law_of(matrix_of(1.3 * TRUE))
    belief, gain = Belief(law, STILL), np.full(len(law.active), 0.3)
    for shot in two_shots(law, LinePlant(TRUE, law)):
        belief.follow(shot)
        belief.keep(shot)
    error = law.reference - shot.response
    np.testing.assert_array_equal(belief.response, law.matrix.response)
    np.testing.assert_array_equal(
        belief.next_drive(shot.drive, error, gain, law.active), update(shot.drive, law.inverse, error, gain)
    )


def test_a_wrong_model_is_corrected_by_how_responses_change_and_its_inverse_with_it() -> None:
    law = law_of(matrix_of(1.3 * TRUE))
    belief = Belief(law, Adaptation(stretch=False, variation=False))
    first, second = two_shots(law, LinePlant(TRUE, law))
    before = missed(belief, first, second)
    for shot in (first, second, first, second, first, second):
        belief.follow(shot)
        belief.keep(shot)
    assert before == pytest.approx(0.3, abs=0.01)
    assert missed(belief, first, second) < 0.1
    np.testing.assert_array_equal(belief.inverse, bounded_inverse(belief.response, law.settings))


def test_distortion_is_expected_in_so_far_as_the_strong_lines_change() -> None:
    law = law_of(matrix_of(TRUE))
    belief = Belief(law, STILL)
    shot = LinePlant(TRUE, law, distortion=0.05).shot(law.start)
    none, some, more = (belief.disturbance(shot, part * law.reference) for part in (0.0, 0.1, 0.2))
    weak = law.matrix.frequency > 120
    assert np.all(none[weak] < 1e-3 * some[weak])
    np.testing.assert_allclose(more[weak], 4 * some[weak], rtol=1e-3)


def test_a_band_that_is_doubted_is_learned_from_experiments_and_no_other() -> None:
    law = law_of(matrix_of(TRUE))
    belief, lines = Belief(law, Adaptation(neighbours=0)), law.matrix.frequency
    band = np.abs(lines - 300.0) < 10.0
    moved = np.where(band[:, None, None], -2.0, 1.0) * LinePlant(TRUE, law).response
    steps = [np.zeros_like(law.start) for _ in range(2)]
    for coil, step in enumerate(steps):
        step[band, coil] = 1.0
    noise = np.full(law.reference.shape, 1e-8)
    belief.relearn(band, 1.0, [(step, (moved @ step[..., None])[..., 0], noise) for step in steps])
    np.testing.assert_allclose(belief.response, moved, rtol=1e-3, atol=1e-3)


def test_lines_apart_say_nothing_of_their_neighbours() -> None:
    chirp, sine = law_of(matrix_of(TRUE)), law_of(matrix_of(TRUE), "sine:50:1")
    assert [Belief(law, Adaptation()).reach for law in (chirp, sine)] == [REACH, 0]
