"""What is watched: a band that diverges is reidentified, and frozen where that does not help."""

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.belief import Belief
from vibractl.learning.law import Law, reference_level
from vibractl.learning.lookout import Lookout, Sighting
from vibractl.transfer_matrix import norm

TRUE = modal(2, 2)
CENTRE = 300.0


class Scene:
    """A lookout over a plant whose G is another one near 300 Hz than is believed."""

    def __init__(self, **watch: object) -> None:
        self.law = law_of(matrix_of(TRUE))
        self.belief = Belief(self.law, Adaptation())
        limit = float(reference_level(self.law.reference).min()) * 10 ** (-40 / 20)
        self.limit, self.near = limit, np.abs(self.law.matrix.frequency - CENTRE) <= 5.0
        self.lookout = Lookout(self.law, Watch.model_validate({"on": True, **watch}), limit)
        self.plant = LinePlant(TRUE, self.law)
        other = np.abs(self.law.matrix.frequency - CENTRE) <= 20.0
        self.plant.response = np.where(other[:, None, None], -self.plant.response, self.plant.response)
        self.shot = self.plant.shot(self.law.start)

    def look(self, over: float) -> Sighting:
        """Look at an error that is over the limit near 300 Hz by so much, and far below it elsewhere."""
        error = np.full(self.law.reference.shape, 1e-3 * self.limit, complex)
        error[self.near] = over * self.limit
        return self.lookout.look(self.shot, error, np.full(len(error), 0.01 * self.limit), self.belief)

    def diverge(self) -> Sighting:
        """Let the error grow until something is found."""
        for over in (0.02, 0.5, 1.0, 2.0, 4.0, 8.0):
            seen = self.look(over)
            if seen.decisions:
                return seen
        raise AssertionError("nothing was found")


def test_a_run_that_goes_well_is_left_alone() -> None:
    scene = Scene()
    assert all(scene.look(0.02) == Sighting() for _ in range(5))
    assert scene.lookout.probing is None


def test_a_band_that_diverges_is_reidentified_from_the_shot_in_which_it_was_found() -> None:
    scene = Scene()
    seen = scene.diverge()
    assert [each.event for each in seen.decisions] == ["divergence", "reidentify"]
    assert seen.decisions[0].fields["at_hz"] == pytest.approx(CENTRE, abs=5.0)
    assert seen.frozen is None
    before, taken = _off(scene), []
    while (drive := scene.lookout.probing) is not None:
        assert np.all((drive != scene.shot.drive).any(axis=1) <= (np.abs(_lines(scene.law) - CENTRE) <= 15.0))
        taken.append(scene.lookout.take(scene.plant.shot(drive), scene.belief, 0.8))
    assert taken[:-1] == [None] * (scene.law.start.shape[1] - 1)
    assert taken[-1] is not None
    base, gained = taken[-1]
    assert base is scene.shot
    assert gained.event == "reidentified"
    assert gained.fields["contraction_before"] > 1.0 > gained.fields["contraction_after"]
    assert _off(scene) < 0.1 * before


def test_after_its_rounds_a_band_is_frozen_and_looked_at_no_more() -> None:
    scene = Scene(rounds=1)
    scene.diverge()
    while scene.lookout.probing is not None:
        scene.lookout.take(scene.plant.shot(scene.lookout.probing), scene.belief, 0.8)
    seen = scene.diverge()
    assert [each.event for each in seen.decisions] == ["divergence", "frozen"]
    assert seen.drive is None
    assert seen.frozen is not None
    assert set(_lines(scene.law)[seen.frozen]) >= set(_lines(scene.law)[scene.near])
    assert all(scene.look(over) == Sighting() for over in (10.0, 20.0, 40.0))


def _lines(law: Law) -> np.ndarray:
    return law.matrix.frequency


def _off(scene: Scene) -> float:
    missed = norm(scene.belief.response - scene.plant.response)[scene.near]
    return float(np.max(missed / norm(scene.plant.response)[scene.near]))
