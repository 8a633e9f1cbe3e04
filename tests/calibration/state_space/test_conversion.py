"""Models to and from python-control and scipy.signal, and their answers beside ours."""

import numpy as np
import pytest
import scipy.signal

from calibration.state_space.conversion import from_control, from_scipy, to_control, to_scipy
from tests.calibration.state_space.test_model import RATE, resonant

FREQUENCY = np.array([1.0, 40.0, 130.0, 499.0])


def test_scipys_discrete_simulation_agrees_with_ours() -> None:
    model, drive = resonant(), np.random.default_rng(1).standard_normal((100, 2))
    _, response, _ = scipy.signal.dlsim(to_scipy(model), drive)
    np.testing.assert_allclose(model.simulate(drive), response, rtol=1e-10, atol=1e-12)


def test_a_model_comes_back_from_scipy_with_the_gain_it_is_given() -> None:
    model = resonant()
    back = from_scipy(to_scipy(model), model.K, model.innovation)
    for name in ("A", "B", "C", "D", "K", "innovation"):
        np.testing.assert_array_equal(getattr(back, name), getattr(model, name))
    assert back.rate == pytest.approx(RATE)


def test_scipys_transfer_functions_become_models() -> None:
    system = scipy.signal.TransferFunction([0.2], [1.0, -0.8], dt=1 / RATE)
    assert from_scipy(system).frequency_response(np.array([0.0]))[0, 0, 0] == pytest.approx(1.0)


def test_python_control_gives_the_same_frequency_response() -> None:
    control = pytest.importorskip("control")
    model = resonant()
    system = to_control(model)
    assert isinstance(system, control.StateSpace)
    theirs = np.moveaxis(system(np.exp(2j * np.pi * FREQUENCY / RATE)), -1, 0)
    np.testing.assert_allclose(model.frequency_response(FREQUENCY), theirs, rtol=1e-9)


def test_a_model_comes_back_from_python_control_with_its_names() -> None:
    pytest.importorskip("control")
    model = resonant()
    back = from_control(to_control(model))
    assert back.input_names == model.input_names
    np.testing.assert_array_equal(back.A, model.A)
    assert np.all(back.K == 0)
    np.testing.assert_array_equal(back.innovation, np.eye(3))


def test_a_continuous_system_or_one_of_unknown_period_is_refused() -> None:
    control = pytest.importorskip("control")
    for period in (0, True):
        with pytest.raises(ValueError, match="the system's sample period is .*, must be > 0 s"):
            from_control(control.ss([[-1.0]], [[1.0]], [[1.0]], [[0.0]], period))
    with pytest.raises(ValueError, match="sample period is None"):
        from_scipy(scipy.signal.StateSpace([[-1.0]], [[1.0]], [[1.0]], [[0.0]]))
