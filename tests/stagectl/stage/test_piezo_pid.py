"""The PID against (2.2), and its design against the bound on Ms."""

import numpy as np
import pytest

from calibration.state_space.model import InnovationModel
from ctlblocks import Graph
from stagectl.config import Limits
from stagectl.stage.controller import PiezoController
from stagectl.stage.piezo_pid import Pid, pid, robust_pid
from tests.stagectl.experiments.piezo.linear_stage import INNER, LAG, LIMITS, RATE, VOLTS, Given

WIDE = Limits(voltage=(-1e4, 1e4), voltage_slew=1e8, extension=(-1.0, 1.0), extension_slew=100.0, ramp=1e-3)


def stack(delay: int = 0) -> InnovationModel:
    """Make a first order from voltage to extension, with whole samples of delay."""
    pole = np.exp(-2 * np.pi * LAG / RATE)
    A, B, C = np.diag(np.ones(delay), -1), np.zeros((delay + 1, 1)), np.zeros((1, delay + 1))
    A[0, 0], B[0, 0], C[0, -1] = pole, VOLTS * (1 - pole), 1.0
    one = np.zeros((1, 1))
    return InnovationModel(A, B, C, one, np.zeros((delay + 1, 1)), RATE, one + 1e-18)


def test_the_block_computes_the_same_as_its_linear_system() -> None:
    settings = Pid(2e5, 3e8, 50.0, 2e-4, 1e-3)
    controller = PiezoController([settings], WIDE)
    controller.prepare(RATE, 400)
    controller.start(np.zeros(1))
    extension = 1e-6 * np.random.default_rng(3).standard_normal((400, 1))
    extension[0] = 0.0  # the reference of zero is then where it starts from
    request = np.empty((400, 1))
    controller.process(np.zeros((400, 1)), extension, request)
    system, state, expected = settings.system(RATE), np.zeros((3, 1)), []
    for error in -extension[:, 0]:
        expected.append((system.C @ state + system.D * error)[0, 0])
        state = system.A @ state + system.B * error
    np.testing.assert_allclose(request[:, 0], expected, rtol=1e-9, atol=1e-9)


def test_feedforward_gives_the_reference_to_the_voltage_at_once_and_makes_no_step_at_a_start() -> None:
    settings = Pid(0.0, 1e6, 0.0, 2e-4, 1e-3, feedforward=1 / VOLTS)
    controller = PiezoController([settings], WIDE)
    controller.prepare(RATE, 20)
    controller.start(np.array([50.0]))
    reference, request = np.full((20, 1), 45e-6), np.empty((20, 1))
    reference[15:] += 9e-6  # after the ramp of a start
    controller.process(reference, np.full((20, 1), 45e-6), request)
    np.testing.assert_allclose(request[:15, 0], 50.0, atol=1e-6)
    assert request[15, 0] == pytest.approx(60.0)


def test_the_integral_does_not_wind_up_behind_a_limit() -> None:
    """An extension out of reach for a second; back within it, the voltage comes off its limit at once."""
    controller = PiezoController([pid(INNER, 0)], LIMITS)
    graph = Graph(RATE)
    reference, extension = Given(1), Given(1)
    for name, block in (("reference", reference), ("extension", extension), ("controller", controller)):
        graph.add(name, block)
    graph.connect("reference.value", "controller.extension_reference")
    graph.connect("extension.value", "controller.extension")
    graph.prepare()
    controller.start(np.array([50.0]))
    reference.value[:], extension.value[:] = 80e-6, 45e-6
    for _ in range(10_000):
        graph.tick()
    assert graph.signal("controller.request")[0, 0] == 100.0
    extension.value[:] = 81e-6
    for _ in range(50):
        graph.tick()
    assert graph.signal("controller.request")[0, 0] < 100.0
    assert controller.met.voltage[0] > 5_000


def test_the_design_is_as_fast_as_asked_where_that_is_robust() -> None:
    settings, figures = robust_pid(stack(), INNER.model_copy(update={"bandwidth": (100.0,)}), 0, 2.0)
    assert settings.integral == pytest.approx(2 * np.pi * 100.0 / VOLTS, rel=1e-6)
    assert figures.max_sensitivity < 2.0


def test_the_design_gets_slower_until_ms_is_within_its_bound() -> None:
    settings, figures = robust_pid(stack(delay=3), INNER.model_copy(update={"bandwidth": (2_000.0,)}), 0, 1.6)
    assert settings.integral < 2 * np.pi * 1_000.0 / VOLTS
    assert 1.3 < figures.max_sensitivity <= 1.6


def test_a_model_with_no_gain_at_rest_is_refused() -> None:
    model = stack()
    turned = InnovationModel(model.A, -model.B, model.C, model.D, model.K, RATE, model.innovation)
    with pytest.raises(ValueError, match="gain at rest is -9e-07 m/V, must be > 0"):
        robust_pid(turned, INNER, 0, 2.0)
