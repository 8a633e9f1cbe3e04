"""That a rig file may name every law there is, and no other."""

from typing import get_args

import pytest

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Learning, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.gains import Gains
from vibractl.learning.kinds_of_law import KINDS, KindOfLaw
from vibractl.learning.laws import ByInverse


def test_the_setting_has_the_laws_of_the_registry() -> None:
    assert get_args(Learning.model_fields["law"].annotation) == tuple(KINDS)


def test_a_law_is_another_line_of_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that starts by the inverse, keeps the model, and has one gain: with a model twice too large, 3/4 are left."""
    half = Gains((0.5,), ())
    monkeypatch.setitem(KINDS, "thesis", KindOfLaw("", ByInverse(), half, half))
    true = modal(2, 2)
    law = law_of(matrix_of(2.0 * true), law="thesis", epsilon=0.0, floor=0.0)
    algorithm, plant = Algorithm(law, Adaptation(), Watch(on=False), -40.0), LinePlant(true, law, 1e-12)
    errors = []
    for _ in range(4):
        shot = plant.shot(algorithm.lines)
        errors.append(abs(law.reference - shot.response).max())
        algorithm.step(shot)
    assert errors[1:] == pytest.approx([0.75 * each for each in errors[:-1]], rel=1e-3)
