"""What a method asks for next: less of its first step in material where the air has shown that the arm answers more."""

import numpy as np
import pytest

from stagectl.experiments.trials.methods import METHODS, ByModels, Milled
from stagectl.experiments.trials.options import IlcOptions
from stagectl.robot.milling.learning import PathLaw, predicted
from stagectl.robot.milling.trial_error import METHODS as ERRORS
from stagectl.robot.milling.trial_error import slow
from tests.stagectl.robot.milling.trial_models import RATE, axis, square

LAW = PathLaw((axis(2), axis(2), axis(2)))
WANTED = square()
AT = np.arange(len(WANTED)) / RATE


def wave(frequency: float) -> np.ndarray:
    """Return 0.1 mm along y."""
    return np.asarray(1e-4 * np.sin(2 * np.pi * frequency * AT)[:, None] * [0.0, 1.0, 0.0])


def asked(*answers: float) -> float:
    """Return how far the first step in material goes, after trials in the air that answered so to the step there."""
    sent, come = [WANTED, WANTED + wave(2.0)], [np.zeros_like(WANTED)]
    come += [predicted(come[0], answer * (sent[1] - sent[0]), LAW) for answer in answers]
    milled = Milled(WANTED, [WANTED], [WANTED - wave(2.0)], [None], (sent[: len(come)], come))
    return float(np.abs(ByModels().next(LAW, milled) - WANTED)[:, 1].max())


def test_a_method_is_known_wherever_it_is_named() -> None:
    assert set(METHODS) == set(ERRORS), "METHODS of trials/methods.py and of robot/milling/trial_error.py differ"
    every = ",".join(map(str, METHODS))
    assert IlcOptions(method=every).method == every, "the pattern of `method` in trials/options.py"


def test_the_first_step_in_material_is_half_where_the_air_was_answered_twofold() -> None:
    assert asked(2.0) == pytest.approx(0.5 * asked(), rel=0.1)
    assert asked(1.0) == pytest.approx(asked(), rel=0.1)


def after_two(*, seen: float | None) -> float:
    """Return how far the third path goes, where the method believes the tool answered as it should, a tracker not."""
    sent, none = [WANTED, WANTED + wave(2.0)], np.zeros_like(WANTED)
    come = [none, predicted(none, sent[1] - sent[0], LAW)]
    witness = [] if seen is None else [none, predicted(none, seen * (sent[1] - sent[0]), LAW)]
    come[1] = WANTED - wave(2.0)  # what is left of the error, as the method believes
    come[0] = come[1] - predicted(none, sent[1] - sent[0], LAW)
    milled = Milled(WANTED, sent, come, [None, None], seen=witness)
    return float(np.abs(ByModels().next(LAW, milled) - sent[1])[:, 1].max())


def test_a_tracker_that_saw_the_tool_answer_twofold_halves_the_step_of_a_method_that_does_not_see_it() -> None:
    assert after_two(seen=1.0) == pytest.approx(after_two(seen=None), rel=0.1)
    assert after_two(seen=2.0) == pytest.approx(0.5 * after_two(seen=None), rel=0.15)


def test_slow_errors_are_those_up_to_the_cutoff_without_phase() -> None:
    inside = slice(len(AT) // 10, -len(AT) // 10)  # at its ends a trial goes on as its mirror image
    np.testing.assert_allclose(slow(wave(2.0) + wave(60.0), 10.0, RATE)[inside], wave(2.0)[inside], atol=1e-6)
