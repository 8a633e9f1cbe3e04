"""Models of thinned records made models at the stage's rate, against the systems that the records came from."""

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.signal import chirp

from calibration.stage_axes.faster import at_rate, control_at_rate, stack_at_rate
from calibration.state_space.model import InnovationModel
from tests.stagectl.experiments.piezo.linear_stage import RATE, model

THIN = 1000.0


def excited(system: InnovationModel) -> tuple[list[np.ndarray], list[np.ndarray]]:
    time = np.arange(round(8 * RATE)) / RATE
    drive = chirp(time, 1.0, time[-1], 200.0)[:, np.newaxis]
    noise = 1e-4 * np.random.default_rng(2).standard_normal((len(drive), system.outputs))
    return [drive], [system.simulate(drive) + noise]


def thinned(system: InnovationModel) -> InnovationModel:
    """Return a model with the same poles and shapes at a tenth of the rate, its inlet not yet right."""
    return InnovationModel(
        np.linalg.matrix_power(system.A, 10), system.B, system.C, system.D, system.K, THIN, system.innovation
    )


def test_response_and_modes_are_those_of_the_fast_system() -> None:
    true = model("x")
    fast = at_rate(thinned(true), *excited(true), RATE)
    frequency = np.linspace(1.0, 200.0, 400)
    expected = true.frequency_response(frequency)[:, 0, 0]
    found = fast.frequency_response(frequency)[:, 0, 0]
    assert fast.rate == RATE
    assert not fast.D.any()
    assert np.abs(found - expected).max() < 2e-3 * np.abs(expected).max()
    np.testing.assert_allclose(fast.modes.frequency[:3], true.modes.frequency[:3], rtol=1e-6)


def test_its_gain_tells_white_noise_on_the_output_from_noise_through_the_modes() -> None:
    true = model("y")
    fast = at_rate(thinned(true), *excited(true), RATE)
    assert fast.innovation[0, 0] == pytest.approx(1e-8, rel=0.05)


def test_a_pole_that_no_continuous_system_has_becomes_one_that_decays_as_fast() -> None:
    true = model("z")
    slow = thinned(true)
    odd = InnovationModel(
        block_diag(slow.A, [[-0.5]]),
        np.vstack([slow.B, [[0.0]]]),
        np.hstack([slow.C, [[1.0]]]),
        slow.D,
        np.vstack([slow.K, [[0.0]]]),
        THIN,
        slow.innovation,
    )
    fast = at_rate(odd, *excited(true), RATE)
    assert np.abs(fast.poles - 0.5**0.1).min() < 1e-6


def test_a_stack_keeps_what_follows_its_voltage_at_once_and_loses_what_creeps() -> None:
    """A gauge that shows a direct part, a resonance and, over seconds, creep."""
    resonance = model("z")
    creep = np.exp(-2 * np.pi * 0.1 / RATE)
    true = InnovationModel(
        A=block_diag(resonance.A, [[creep]], [[0.0]]),
        B=np.vstack([resonance.B, [[0.2 * (1 - creep)]], [[1.0]]]),
        C=np.hstack([0.05 * resonance.C, [[1.0, 1.0]]]),
        D=np.zeros((1, 1)),
        K=np.zeros((resonance.order + 2, 1)),
        rate=RATE,
        innovation=np.ones((1, 1)),
    )
    fast = stack_at_rate(thinned(true), *excited(true), RATE)
    assert fast.modes.frequency.min() > 60.0
    rest = fast.frequency_response(np.zeros(1))[0, 0, 0].real
    assert rest == pytest.approx(1.0 + 0.05 * 5.0, rel=0.02)


def crept(resonance: InnovationModel, corner: float, gain: float) -> InnovationModel:
    """Return a system with a slow pole, of that corner, Hz, and gain at rest, m/m, beside a resonance."""
    slow = np.exp(-2 * np.pi * corner / RATE)
    return InnovationModel(
        A=block_diag(resonance.A, [[slow]]),
        B=np.vstack([resonance.B, [[gain * (1 - slow)]]]),
        C=np.hstack([resonance.C, [[1.0]]]),
        D=np.zeros((1, 1)),
        K=np.zeros((resonance.order + 1, 1)),
        rate=RATE,
        innovation=np.ones((1, 1)),
    )


@pytest.mark.parametrize("gain", [2.0, -20.0])
def test_a_model_for_a_loop_has_no_creep_and_the_gain_of_what_is_faster(gain: float) -> None:
    resonance = model("z")
    true = crept(resonance, 0.05, gain)
    fast = control_at_rate(thinned(true), *excited(true), RATE)
    assert fast.order == resonance.order
    at = np.array([0.0, 5.0, 20.0, 74.0])
    expected = resonance.frequency_response(at)[:, 0, 0]
    np.testing.assert_allclose(fast.frequency_response(at)[:, 0, 0], expected, rtol=0.03)
    assert np.abs(np.linalg.eigvals(fast.A - fast.K @ fast.C)).max() < 1.0


def test_a_slow_pair_that_rings_is_no_resonance() -> None:
    """As creep and an inner loop may give it, at 0.7 Hz."""
    resonance, turn = model("z"), 2 * np.pi * 0.7 / RATE
    size = np.exp(-0.17 * turn)
    slow = size * np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    true = InnovationModel(
        block_diag(resonance.A, slow),
        np.vstack([resonance.B, [[2e-3], [0.0]]]),
        np.hstack([resonance.C, [[1.0, 0.0]]]),
        np.zeros((1, 1)),
        np.zeros((resonance.order + 2, 1)),
        RATE,
        np.ones((1, 1)),
    )
    fast = control_at_rate(thinned(true), *excited(true), RATE)
    assert fast.order == resonance.order
    assert fast.modes.frequency.min() > 60.0
    stack = stack_at_rate(thinned(true), *excited(true), RATE)  # whose gain at rest an inner loop is made for
    assert stack.modes.frequency.min() > 60.0


def test_a_model_for_a_loop_keeps_a_lag_that_is_no_slower_than_its_mechanics() -> None:
    true = crept(model("z"), 40.0, 2.0)
    fast = control_at_rate(thinned(true), *excited(true), RATE)
    assert fast.order == true.order
    at = np.array([0.0, 20.0, 40.0, 100.0])
    np.testing.assert_allclose(
        fast.frequency_response(at)[:, 0, 0], true.frequency_response(at)[:, 0, 0], rtol=0.02, atol=0.02
    )


def test_what_rings_above_all_that_was_excited_is_no_part_of_a_model_for_a_loop() -> None:
    true = model("z")
    slow, turn = thinned(true), 2 * np.pi * 0.45
    ghost = 0.99 * np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    haunted = InnovationModel(
        block_diag(slow.A, ghost),
        np.vstack([slow.B, np.zeros((2, 1))]),
        np.hstack([slow.C, [[1e-3, 0.0]]]),
        slow.D,
        np.vstack([slow.K, np.zeros((2, 1))]),
        THIN,
        slow.innovation,
    )
    assert at_rate(haunted, *excited(true), RATE).order == true.order + 2
    assert control_at_rate(haunted, *excited(true), RATE).order == true.order


def test_a_stack_that_nothing_rings_in_is_what_follows_its_voltage_at_once() -> None:
    corner = 3.0
    lag = np.exp(-2 * np.pi * corner / RATE)
    still = InnovationModel(
        np.array([[lag]]), np.array([[0.5 * (1 - lag)]]), np.ones((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)),
        RATE, np.ones((1, 1)),
    )  # fmt: skip
    drives, responses = excited(still)
    responses = [each + 2.0 * np.vstack([[[0.0]], drive[:-1]]) for drive, each in zip(drives, responses, strict=True)]
    fast = stack_at_rate(thinned(still), drives, responses, RATE)
    assert fast.frequency_response(np.array([50.0]))[0, 0, 0].real == pytest.approx(2.0, rel=0.05)
