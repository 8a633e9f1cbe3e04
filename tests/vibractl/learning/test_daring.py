"""How much is dared, and what that promises."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation
from vibractl.learning.belief import Belief
from vibractl.learning.daring import Daring
from vibractl.learning.law import Law
from vibractl.learning.shot import Shot

TRUE = modal(2, 2)


def made(is_cautious: bool, noise: float = 1e-6) -> tuple[Law, Belief, Daring, Shot, np.ndarray]:
    """Return what one shot on a linear plant is learned with, and the error that it left."""
    law = law_of(matrix_of(1.05 * TRUE))
    belief = Belief(law, Adaptation())
    shot = LinePlant(TRUE, law, noise=noise).shot(law.start)
    return law, belief, Daring(law, is_cautious, belief), shot, law.reference - shot.response


def test_without_caution_every_line_has_the_gain_of_the_schedule() -> None:
    law, belief, daring, shot, error = made(is_cautious=False, noise=1e-2)
    for updates, gain in ((0, 0.8), (6, 0.8), (7, 0.4)):
        daring.updates = updates
        daring.choose(belief, shot, error, 1.0)
        assert daring.nominal == gain
        np.testing.assert_array_equal(daring.gain, gain * law.active)
    daring.choose(belief, shot, error, 0.5)
    assert daring.nominal == 0.2


def test_caution_takes_less_where_the_error_is_mostly_noise() -> None:
    law, belief, daring, shot, error = made(is_cautious=True, noise=1e-3)
    daring.choose(belief, shot, error, 1.0)
    size, strong = np.linalg.norm(error, axis=1), (law.matrix.frequency > 45) & (law.matrix.frequency < 85)
    assert np.median(daring.gain[strong]) > 0.6
    assert np.median(daring.gain[size < 2e-3]) < 0.5 * daring.nominal
    assert np.all(daring.gain <= daring.nominal)


def test_distortion_slows_the_lines_that_move_it_and_not_those_it_is_learned_at() -> None:
    law = law_of(matrix_of(1.5 * TRUE))
    belief = Belief(law, Adaptation())
    shot = LinePlant(TRUE, law, distortion=0.3).shot(law.start)
    shot = Shot(shot.drive, shot.response + 0.3 * np.roll(shot.response, 1, axis=0), shot.noise)
    daring = Daring(law, True, belief)
    daring.choose(belief, shot, law.reference - shot.response, 1.0)
    assert np.median(daring.gain[belief.strong]) < 0.5 * daring.nominal
    weak = ~belief.strong & (law.matrix.frequency > 100)
    assert np.min(daring.gain[weak]) > 0.99 * daring.nominal
    counted = replace(law, importance=np.where(law.matrix.frequency > 120, 100.0, 1.0))
    daring = Daring(counted, True, belief)
    daring.choose(belief, shot, law.reference - shot.response, 1.0)
    assert np.median(daring.gain[weak & counted.counts_less]) < 0.5 * daring.nominal
    assert np.min(daring.gain[weak & ~counted.counts_less]) > 0.99 * daring.nominal


def test_frozen_lines_are_learned_no_more_and_are_not_expected_of() -> None:
    law, belief, daring, shot, error = made(is_cautious=True)
    before, frozen = daring.expected, np.arange(len(law.active)) % 2 == 0
    daring.freeze(frozen)
    daring.choose(belief, shot, error, 1.0)
    assert np.all(daring.gain[frozen] == 0)
    assert np.all(daring.gain[~frozen] > 0)
    assert before > np.linalg.norm(daring.error_bound[~frozen]) == pytest.approx(daring.expected)


def test_bounds_that_did_not_hold_are_widened_and_what_was_computed_is_told_apart() -> None:
    _, belief, daring, shot, error = made(is_cautious=False)
    daring.choose(belief, shot, error, 1.0)
    np.testing.assert_array_equal(daring.computed_bound, daring.error_bound)
    promised = daring.error_bound.copy()
    daring.updates = 1
    larger = 3.0 * promised[:, None] * error / np.linalg.norm(error, axis=1)[:, None]
    daring.choose(belief, shot, larger, 1.0)
    np.testing.assert_allclose(daring.error_bound, 3.0 * daring.computed_bound, rtol=1e-6)
