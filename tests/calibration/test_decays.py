"""Free responses over long records end in zeros: no sum over time is slowed down by subnormal numbers."""

import numpy as np
import pytest

from calibration.prediction_error import normal_equations
from calibration.prediction_error.normal_equations import Record
from calibration.prediction_error.parallel_form import ParallelForm, decomposed, joined
from calibration.state_space.model_kernel import transient
from calibration.subspace import modal_regression
from calibration.subspace.modal import modal
from calibration.subspace.modal_regression import responses, sums
from stagectl.stage.hysteresis_kernel import lag
from tests.calibration.prediction_error.test_local_coordinates import POLES, system
from tests.calibration.state_space.test_model import resonant

SAMPLES = 30_000
MODEL = resonant()


def has_died_away(signals: np.ndarray) -> bool:
    """Whether there is nothing subnormal on the way to zeros."""
    size = np.abs(signals)
    return bool(size.any() and not size[-1].any() and not ((size > 0) & (size < np.finfo(float).tiny)).any())


def test_the_free_decays_of_a_models_modes_end_in_zeros(monkeypatch: pytest.MonkeyPatch) -> None:
    """The columns that stay there for good: nothing drives them."""
    modes, blocks, seen = modal(MODEL.A), modal_regression._blocks, []  # noqa: SLF001
    monkeypatch.setattr(
        modal_regression, "_blocks", lambda *given: ((at, (seen.append(b.copy()), b)[1]) for at, b in blocks(*given))
    )
    sums(modes, np.random.default_rng(1).standard_normal((SAMPLES, 2)), np.zeros((SAMPLES, 3)))
    filtered = np.concatenate(seen)[:, : 2 * len(modes.poles) * 3]
    decays = np.concatenate([half[:, 2 * len(modes.poles) :] for half in np.split(filtered, 2, axis=1)], axis=1)
    assert has_died_away(decays)


def test_a_response_to_a_first_state_alone_ends_in_zeros() -> None:
    silence, state = np.zeros((SAMPLES, 2)), np.ones(4)
    assert has_died_away(responses(modal(MODEL.A), MODEL.C, MODEL.B, silence, state))
    assert has_died_away(MODEL.simulate(silence, state))
    assert has_died_away(MODEL.predict(silence, np.zeros((SAMPLES, 3)), state))


def test_the_transient_of_a_state_ends_in_zeros() -> None:
    free = np.empty((SAMPLES, *MODEL.C.shape))
    transient(np.ascontiguousarray(MODEL.A), MODEL.C.copy(), free)
    assert has_died_away(free)


def form(kind: str) -> ParallelForm:
    element = system(POLES[kind], seed=4)
    return joined([decomposed(element.a, element.b, element.c, element.first)[0]], np.zeros((2, 0)))


@pytest.mark.parametrize("kind", POLES)
def test_a_parallel_form_and_its_derivatives_end_in_zeros(kind: str) -> None:
    given = form(kind)
    record, state = Record(np.zeros((SAMPLES, 3)), np.zeros((SAMPLES, 2))), np.ones(given.sections.order)
    assert has_died_away(normal_equations.residual(given, record, state))
    (slopes,) = normal_equations._derivatives(given, record, state, SAMPLES)  # noqa: SLF001
    assert has_died_away(slopes)


def test_what_lags_behind_a_signal_that_ended_ends_in_zeros() -> None:
    signal = np.zeros(SAMPLES)
    signal[0] = 1.0
    lag(signal, 0.95)
    assert has_died_away(signal)
