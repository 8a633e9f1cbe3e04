"""A run that begins faint: it rises as the limit allows, takes back what was too much, and arrives."""

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import FREQUENCY, LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.law import Law, reference_level
from vibractl.learning.shot import Shot
from vibractl.learning.soft_start import BROKEN, FAINT, LARGER, SoftStart

OBJECTIVE = -40.0
TRUE = modal(2, 2)


def judged_of(law: Law) -> np.ndarray:
    judged: np.ndarray = law.matrix.frequency >= 100
    return judged


def led(law: Law, plant: LinePlant, count: int) -> tuple[Algorithm, list[float], list[float]]:
    """Run so many shots that begin faint; return the algorithm, and of each shot the level and the loudest line."""
    judged = judged_of(law)
    algorithm = Algorithm(law, Adaptation(), Watch(), OBJECTIVE, rising=judged)
    limit = reference_level(law.reference) * 10 ** (OBJECTIVE / 20)
    levels, loudest = [], []
    for _ in range(count):
        shot = plant.shot(algorithm.lines)
        levels.append(algorithm.level)
        error = algorithm.level * law.reference - shot.response
        loudest.append(float((np.abs(error) / limit)[judged].max()))
        algorithm.step(shot)
    return algorithm, levels, loudest


def test_a_machine_without_distortion_is_at_full_level_after_six_doublings() -> None:
    law = law_of(matrix_of(TRUE))
    algorithm, levels, loudest = led(law, LinePlant(TRUE, law), 9)
    assert levels[0] == pytest.approx(FAINT * 10 ** (OBJECTIVE / 20))
    assert levels[5:8] == pytest.approx([0.64, 1.0, 1.0])
    assert max(loudest) < 0.2
    assert algorithm.purpose == "learn"


@pytest.mark.sample(1)
@pytest.mark.parametrize(("distortion", "shots"), [(0.03, 20), (0.1, 40), (0.3, 80)])
def test_distortion_far_over_the_limit_is_learned_on_the_way_and_never_heard(distortion: float, shots: int) -> None:
    """At full level at once it is up to 30 dB over: 30 % of the reference on every line."""
    law = law_of(matrix_of(TRUE))
    plant = LinePlant(TRUE, law, distortion=distortion)
    _, levels, loudest = led(law, plant, shots)
    assert levels[-1] == 1.0
    assert max(loudest) <= 1.0
    assert levels == sorted(levels)
    at_once = Algorithm(law, Adaptation(), Watch(), OBJECTIVE)
    over = np.abs(law.reference - plant.shot(at_once.lines).response)[judged_of(law)].max()
    assert over > 3 * reference_level(law.reference).max() * 10 ** (OBJECTIVE / 20)


@pytest.mark.sample(1)
@pytest.mark.parametrize("wrong", [0.4, 2.5])
def test_a_model_that_is_wrong_by_a_factor_costs_shots_and_1_db_at_most(wrong: float) -> None:
    law = law_of(matrix_of(wrong * TRUE, deviation=0.5))
    _, levels, loudest = led(law, LinePlant(TRUE, law, distortion=0.1), 40)
    assert levels[-1] == 1.0
    assert max(loudest) <= 1.1


def test_half_of_a_rise_that_was_too_much_is_taken_back_and_then_all_of_it() -> None:
    law = law_of(matrix_of(TRUE))
    soft = SoftStart(law, judged_of(law), OBJECTIVE)
    limit = reference_level(law.reference) * 10 ** (OBJECTIVE / 20)
    quiet, loud = (np.tile(part * limit, (len(law.reference), 1)) for part in (0.01, 2 * BROKEN))
    shot, nothing = Shot(law.start, law.reference, np.zeros(law.reference.shape)), np.zeros(law.start.shape)
    drive, _ = soft.onward(shot, quiet, soft.level * law.start, nothing)
    risen = soft.level
    assert risen == pytest.approx(LARGER * FAINT / 100)
    np.testing.assert_allclose(drive, risen * law.start)
    drive, decided = soft.onward(shot, loud, drive, nothing)
    assert soft.level == pytest.approx(0.75 * risen)
    np.testing.assert_allclose(drive, soft.level * law.start)
    assert decided is not None
    assert decided.fields["loudest_db"] == pytest.approx(20 * np.log10(2 * BROKEN), abs=0.1)
    drive, _ = soft.onward(shot, loud, drive, nothing)
    assert soft.level == pytest.approx(0.5 * risen)
    np.testing.assert_allclose(drive, soft.level * law.start)
    soft.onward(shot, loud, drive, nothing)
    assert soft.level == pytest.approx(0.5 * risen)  # it was not the rise: learning goes on there


def test_a_rise_that_was_far_too_much_is_taken_back_at_once() -> None:
    """As where a joint gives way, or a coil leaves its field."""

    class Sudden(LinePlant):
        def distorted(self, linear: np.ndarray) -> np.ndarray:
            wanted = self._wanted[self._strong]
            level = abs(np.vdot(wanted, linear[self._strong]) / np.vdot(wanted, wanted))
            return super().distorted(linear) if level > 0.3 else np.zeros_like(linear)

    law = law_of(matrix_of(TRUE))
    _, levels, loudest = led(law, Sudden(TRUE, law, distortion=3.0), 30)
    over = np.array(loudest) > 1.0
    assert over.any()
    assert not (over[:-1] & over[1:]).any()
    assert levels[-1] < 0.35


def test_what_noise_may_be_keeps_no_level_down() -> None:
    law = law_of(matrix_of(TRUE))
    level = float(reference_level(law.reference).max())
    noisy = LinePlant(TRUE, law, noise=0.005 * level)  # its largest line of a shot is over the limit
    _, levels, loudest = led(law, noisy, 20)
    assert max(loudest) > 1.0
    assert levels[-1] == 1.0


def test_what_never_can_be_learned_holds_the_level_where_it_is_at_the_limit() -> None:
    """Distortion that changes its phase from shot to shot, 20 dB over the limit at full level."""

    class Fickle(LinePlant):
        def distorted(self, linear: np.ndarray) -> np.ndarray:
            turned: np.ndarray = super().distorted(linear) * np.exp(2j * np.pi * self._rng.random((len(linear), 1)))
            return turned

    law = law_of(matrix_of(TRUE))
    _, levels, loudest = led(law, Fickle(TRUE, law, distortion=0.1), 40)
    assert 0.2 < levels[-1] < 0.8
    assert np.median(loudest[20:]) <= 1.1
    assert max(loudest) < 2.0


def test_lines_below_those_that_are_judged_do_not_count() -> None:
    law = law_of(matrix_of(TRUE))
    soft = SoftStart(law, judged_of(law), OBJECTIVE)
    error = np.where(FREQUENCY[1:-1, None] < 100, 1e3, 1e-9) * np.ones((1, 2))
    assert len(error) == len(law.reference)
    assert soft.emission(error, np.zeros(error.shape)).over < 1e-3
