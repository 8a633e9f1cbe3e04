"""Plants of scipy.signal and python-control become plain arrays, dead time included."""

import control
import numpy as np
import pytest
from scipy.signal import TransferFunction, cont2discrete, dlti, lti

from rigkit.discrete_system import arrays_of, impulse_response, is_system

PERIOD, LATE = 0.005, 3
_found = cont2discrete(([2500.0], [1.0, 10.0, 2500.0]), PERIOD)
NUMERATOR, DENOMINATOR = np.squeeze(_found[0])[1:], np.r_[_found[1], np.zeros(LATE)]


@pytest.mark.parametrize(
    "system",
    [
        dlti(NUMERATOR, DENOMINATOR, dt=PERIOD),
        dlti(NUMERATOR, DENOMINATOR, dt=PERIOD).to_ss(),
        dlti(NUMERATOR, DENOMINATOR, dt=PERIOD).to_zpk(),
        control.tf(NUMERATOR, DENOMINATOR, PERIOD),
        control.ss(control.tf(NUMERATOR, DENOMINATOR, PERIOD)),
    ],
    ids=["dlti", "scipy's state space", "zeros and poles", "control's transfer function", "control's state space"],
)
def test_every_kind_of_system_has_the_same_impulse_response(system: object) -> None:
    wanted = np.ravel(dlti(NUMERATOR, DENOMINATOR, dt=PERIOD).impulse(n=40)[1])
    assert is_system(system)
    found = impulse_response(arrays_of(system), 40)
    assert np.all(np.abs(found[: 1 + LATE]) < 1e-12)
    assert found[1 + LATE] > 0.1 * np.abs(found).max()
    np.testing.assert_allclose(found, wanted, atol=1e-5 * np.abs(wanted).max())


def test_a_direct_term_answers_in_the_same_sample() -> None:
    state_space = ([[0.5]], [[1.0]], [[2.0]], [[3.0]])
    np.testing.assert_allclose(impulse_response(state_space, 4), [3.0, 2.0, 1.0, 0.5])
    np.testing.assert_allclose(impulse_response(state_space[:3], 3), [0.0, 2.0, 1.0])
    np.testing.assert_allclose(impulse_response(([3.0, 0.5], [1.0, -0.5]), 4), [3.0, 2.0, 1.0, 0.5])


@pytest.mark.parametrize(
    ("system", "text"),
    [
        (lti([1.0], [1.0, 1.0]), "dt = None, must be > 0 s: sample it first"),
        (control.tf([1.0], [1.0, 1.0]), "dt = 0, must be > 0 s"),
        (TransferFunction([[1.0], [0.5]], [1.0, 0.5], dt=0.1), "several inputs or outputs"),
        (control.frd([1.0, 2.0], [1.0, 2.0], dt=0.1), "FrequencyResponseData, must be a transfer function"),
    ],
)
def test_a_system_that_is_none_of_these_is_refused(system: object, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        arrays_of(system)


@pytest.mark.parametrize(
    ("arrays", "text"),
    [
        (([1.0],), "1 arrays, must be"),
        (([1.0, 2.0, 3.0], [1.0, 0.5]), "3 coefficients over 2"),
        (([[0.5]], [[1.0], [1.0]], [[1.0]]), r"B \(2, 1\)"),
    ],
)
def test_arrays_of_another_form_are_refused(arrays: tuple[object, ...], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        impulse_response(arrays, 5)  # type: ignore[arg-type]
