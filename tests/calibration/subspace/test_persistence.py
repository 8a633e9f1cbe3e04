"""How much inputs excite."""

import numpy as np
import pytest

from calibration import subspace
from calibration.subspace.diagnosis import Diagnosis
from calibration.subspace.excitation import MOST, persistence, repeated
from calibration.subspace.feedback import Feedback
from calibration.subspace.nonlinearity import Nonlinearity
from tests.calibration.resonant_systems import RATE, order_7

TIME = np.arange(800.0)
LINEAR = Nonlinearity(np.zeros(1), np.ones(1))


@pytest.mark.parametrize("sines", [1, 2, 5])
def test_so_many_sines_excite_twice_as_much(sines: int) -> None:
    drive = np.sin(np.outer(TIME, 0.3 + 0.31 * np.arange(sines))).sum(axis=1, keepdims=True)
    assert persistence([drive]) == 2 * sines


def test_noise_excites_whatever_is_asked_and_an_input_twice_nothing() -> None:
    noise = np.random.default_rng(1).standard_normal((800, 2))
    assert persistence([noise]) == MOST
    assert persistence([noise[:, [0, 0]]]) == 0
    assert repeated([noise]) is None
    assert repeated([np.column_stack([noise, -noise[:, 0]])]) == (0, 2)


def test_a_model_of_what_a_sine_excites_is_called_guessed() -> None:
    drive = np.sin(0.3 * TIME)[:, None]
    found = subspace.identify(*order_7().record(800, seed=1, drive=drive), RATE, order=5, horizon=15)
    assert "inputs excite persistently of order 2 only, 10 is wanted: much of the model is not identifiable" in str(
        found.diagnosis
    )


def test_verdicts_name_what_is_wrong() -> None:
    bad = Diagnosis(8, 1, 1, 300, MOST, 1e-5, 0.2, Feedback(np.array([0.6]), np.array([1e-9]), 0.1), True, 2, LINEAR)
    text = str(bad)
    for said in (
        "300 samples are few for 25 coefficients",
        "are not white",
        "20 % of the residuals' correlations with earlier inputs",
        "input 1 follows from the outputs, which predict 60 % of its innovations: a loop was closed",
        "2 poles were moved into the unit circle",
    ):
        assert said in text
    good = Diagnosis(4, 1, 1, 3000, MOST, 0.5, 0.01, Feedback(np.zeros(1), np.ones(1), 0.1), False, 0, LINEAR)
    assert len(good.sentences) == 3


def test_an_output_that_the_inputs_do_not_explain_is_told_of() -> None:
    u, y = np.random.default_rng(1).standard_normal((2, 2000))
    assert "the free run explains next to nothing of output 1" in str(subspace.identify(u, y, 100.0).diagnosis)
    heard = subspace.identify(u, np.convolve(u, [0.0, 1.0, 0.5])[:2000] + 0.1 * y, 100.0)
    assert "next to nothing" not in str(heard.diagnosis)
