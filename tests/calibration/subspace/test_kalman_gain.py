"""The Kalman gain: from known noise, by Riccati, refined, and where there is no solution."""

import numpy as np
import pytest
from scipy.linalg import LinAlgError

from calibration.subspace import kalman_gain as module
from calibration.subspace.estimate import compress, estimate
from calibration.subspace.gain_refinement import refine_gain
from calibration.subspace.kalman_gain import Gain, halved_until_stable, is_stable
from calibration.subspace.regression import Terms
from calibration.subspace.signals import signals
from calibration.subspace.weighting import left_by_free_run, weighted
from calibration.subspace.windows import Layout, Windows
from tests.calibration.resonant_systems import order_7, order_9

TERMS = Terms(direct=True, constant=True)


def prepared(past: int = 40, samples: int = 10_000):  # type: ignore[no-untyped-def]  # a test's own pieces
    """Return an order 9 record, scaled, and its estimate before the gain is refined."""
    data = signals(*([each] for each in order_9().record(samples, seed=1)), True)
    windows = Windows(data.joined, Layout(past, 20, 1, 3), 1, constant=True)
    return data, estimate(compress(windows, "moesp"), 9, data.drives, data.responses, TERMS)


def test_innovations_are_as_large_as_the_true_ones() -> None:
    data, found = prepared(past=80)
    truth = order_9().model.innovation / np.outer(data.output_scale, data.output_scale)
    assert found.gain.by_riccati
    np.testing.assert_allclose(np.diag(found.gain.innovation), np.diag(truth), rtol=0.12)


def test_refining_lowers_the_innovations_to_the_true_ones() -> None:
    data, found = prepared(past=15)
    truth = order_9().model.innovation / np.outer(data.output_scale, data.output_scale)
    left = left_by_free_run(found, data.drives, data.responses)
    refined = refine_gain(found.transition, found.outlet, found.gain, left)
    wanted, before, after = (np.linalg.slogdet(each)[1] for each in (truth, found.gain.innovation, refined.innovation))
    assert before > wanted + 0.1
    assert after == pytest.approx(wanted, abs=0.05)
    assert is_stable(found.transition - refined.matrix @ found.outlet)


def test_refining_begins_anew_where_the_gain_given_is_worse_than_none() -> None:
    data, found = prepared()
    left = left_by_free_run(found, data.drives, data.responses)
    good = refine_gain(found.transition, found.outlet, found.gain, left)
    wrong = Gain(-0.2 * found.gain.matrix, found.gain.innovation, by_riccati=True)
    again = refine_gain(found.transition, found.outlet, wrong, left)
    assert np.linalg.slogdet(again.innovation)[1] == pytest.approx(np.linalg.slogdet(good.innovation)[1], abs=0.02)


def test_long_records_are_refined_as_short_ones() -> None:
    """Most steps see the beginning only, the last one all."""
    data, found = prepared(samples=45_000)
    left = left_by_free_run(found, data.drives, data.responses)
    truth = order_9().model.innovation / np.outer(data.output_scale, data.output_scale)
    refined = refine_gain(found.transition, found.outlet, found.gain, left)
    assert np.linalg.slogdet(refined.innovation)[1] == pytest.approx(np.linalg.slogdet(truth)[1], abs=0.02)


def test_without_a_riccati_solution_the_predictor_is_stable_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise LinAlgError("no solution")

    monkeypatch.setattr(module, "solve_discrete_are", fail)
    _, found = prepared()
    assert not found.gain.by_riccati
    assert np.any(found.gain.matrix)
    assert is_stable(found.transition - found.gain.matrix @ found.outlet)


def test_a_gain_too_large_is_halved_until_the_predictor_is_stable() -> None:
    transition, outlet = np.array([[0.9]]), np.array([[1.0]])
    assert halved_until_stable(transition, outlet, np.array([[1.5]])) == 1.5
    assert halved_until_stable(transition, outlet, np.array([[6.0]])) == 1.5
    assert halved_until_stable(transition, outlet, np.array([[np.inf]])) == 0.0


def test_weighting_keeps_to_a_free_run_that_a_simple_model_needs() -> None:
    """Of order 4 the model lacks modes; what it predicts best would be a worse free run."""
    drive, response = order_7().record(10_000, seed=2)
    data = signals([drive], [response + drive], True)
    windows = Windows(data.joined, Layout(20, 20, 1, 1), 1, constant=True)
    for order, changed in ((4, False), (7, True)):
        found = estimate(compress(windows, "moesp"), order, data.drives, data.responses, TERMS)
        left = left_by_free_run(found, data.drives, data.responses)
        gain = refine_gain(found.transition, found.outlet, found.gain, left)
        again = weighted(found, gain, data.drives, data.responses, TERMS)
        assert (again is not found) is changed
        assert again.left <= 1.02 * found.left
