"""That learning which stands still is told, once, with what stands in the way."""

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.decision import Decision
from vibractl.learning.stagnation import WAIT, Stagnation

TRUE = modal(2, 2)


def learned(noise: float = 1e-6, wrong: float = 1.2) -> tuple[Algorithm, LinePlant]:
    law = law_of(matrix_of(wrong * TRUE))
    algorithm, plant = Algorithm(law, Adaptation(), Watch(), -40.0), LinePlant(TRUE, law, noise, distortion=0.03)
    algorithm.step(plant.shot(algorithm.lines))
    return algorithm, plant


def told(algorithm: Algorithm, plant: LinePlant, overs: list[float], hz: float) -> tuple[list[Decision], Stagnation]:
    stagnation, shot = Stagnation(), plant.shot(algorithm.lines)
    found = [stagnation.take(over, hz, shot, algorithm) for over in overs]
    return [decision for decision in found if decision is not None], stagnation


def test_shots_that_get_better_or_are_good_say_nothing() -> None:
    algorithm, plant = learned()
    for overs in ([20.0 - 1.5 * n for n in range(12)], [-3.0] * 20, [5.0] * WAIT):
        decisions, stagnation = told(algorithm, plant, overs, 200.0)
        assert (decisions, stagnation.text) == ([], "")


def test_it_is_told_once_and_is_over_when_a_shot_is_better() -> None:
    algorithm, plant = learned()
    decisions, stagnation = told(algorithm, plant, [5.0] * (WAIT + 4), 200.0)
    assert [decision.event for decision in decisions] == ["stands_still"]
    assert decisions[0].fields["over_db"] == 5.0
    assert stagnation.text == decisions[0].fields["because"]
    stagnation.take(3.9, 200.0, plant.shot(algorithm.lines), algorithm)
    assert stagnation.text == ""


def test_errors_that_grow_are_told_once_and_as_long_as_they_do() -> None:
    algorithm, plant = learned()
    decisions, stagnation = told(algorithm, plant, [26.0, 35.0, 55.0, 63.0, 64.0], 200.0)
    assert [decision.event for decision in decisions] == ["errors_grow"]
    assert decisions[0].fields == {"over_db": 63.0, "first_db": 26.0, "at_hz": 200.0}
    assert stagnation.text.startswith(
        "errors grow, from 26 to 64 dB over the limit: the response differs from the model"
    )
    decisions, stagnation = told(algorithm, plant, [26.0, 40.0, 25.0, 40.0, 20.0], 200.0)
    assert (decisions, stagnation.text) == ([], "")
    decisions, stagnation = told(algorithm, plant, [-20.0, 5.0, 5.0, 5.0], 200.0)
    assert decisions == []


@pytest.mark.parametrize(
    ("noise", "wrong", "hz", "because"),
    [
        (0.3, 1.2, 200.0, "noise and hum at 200.0 Hz are about as strong as the error"),
        (
            1e-6,
            2.5,
            200.0,
            "distortion at 200.0 Hz follows the reference's own bins, whose error is",
        ),
        (
            1e-6,
            1.2,
            200.0,
            "at 200.0 Hz the error returns after each update: the plant changes, or differs from the model",
        ),
        (1e-6, 1.2, 700.0, "nothing is learned at 700.0 Hz"),
    ],
    ids=["noise", "distortion", "model", "beyond"],
)
def test_it_says_what_stands_in_the_way(noise: float, wrong: float, hz: float, because: str) -> None:
    algorithm, plant = learned(noise, wrong)
    _, stagnation = told(algorithm, plant, [5.0] * (WAIT + 1), hz)
    assert stagnation.text.startswith(f"learning has stalled: {because}")


def test_a_frozen_line_is_not_learned() -> None:
    algorithm, plant = learned()
    algorithm.daring.freeze(np.abs(algorithm.law.matrix.frequency - 200.0) < 5)
    _, stagnation = told(algorithm, plant, [5.0] * (WAIT + 1), 200.0)
    assert stagnation.text == "learning has stalled: nothing is learned at 200.0 Hz"
