"""Refined state spaces: as good as the truth, as certain as they say, stable, and whole in whatever way they start."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.fit_measures import fit
from calibration.prediction_error import refine
from calibration.prediction_error.scale import scale_of
from calibration.state_space.model import InnovationModel
from tests.calibration.resonant_systems import ResonantSystem, order_7, order_9, order_18

SAMPLES = 10_000


def spoiled(model: InnovationModel, seed: int = 0) -> InnovationModel:
    """Return a model some way off: damping and gains wrong, half of K, states turned."""
    rng = np.random.default_rng(seed)
    b, c = (1 + 0.05 * rng.standard_normal(part.shape) for part in (model.B, model.C))
    turn = np.linalg.qr(rng.standard_normal(model.A.shape))[0]
    rough = replace(model, A=0.9995 * model.A, B=b * model.B, C=c * model.C, K=0.5 * model.K)
    return replace(rough, A=turn.T @ rough.A @ turn, B=turn.T @ rough.B, C=rough.C @ turn, K=turn.T @ rough.K)


@pytest.mark.parametrize("system", [order_7(), order_9(), order_18()], ids=["7", "9", "18"])
def test_it_comes_within_0_1_point_of_the_truth(system: ResonantSystem) -> None:
    """Free run and one step ahead, on fresh data; the damping of every mode within 3 % or three standard errors."""
    found = refine(spoiled(system.model), *system.record(SAMPLES, seed=1))
    fresh = system.record(SAMPLES, seed=2)
    best, reached = (fit(model, *([part] for part in fresh)) for model in (system.model, found.model))
    assert found.arrived
    assert reached.one_step.nrmse.mean() > best.one_step.nrmse.mean() - 0.02 * system.model.inputs**2
    assert reached.free_run.nrmse.mean() > best.free_run.nrmse.mean() - 0.1 * system.model.inputs
    off = np.abs(found.errors.modes.damping - system.model.modes.damping)
    assert np.all(off <= np.maximum(0.03 * system.model.modes.damping, 3 * found.errors.damping))


@pytest.mark.slow
def test_standard_errors_cover_and_reach_the_cramer_rao_bound() -> None:
    """Over 60 records: errors scatter as widely as said, and no wider than at the true parameters."""
    system = order_7()
    true = system.model.modes
    found = [refine(system.model, *system.record(2000, seed=100 + seed)).errors for seed in range(60)]
    for name in ("frequency", "damping"):
        off = np.array([getattr(each.modes, name)[1:] - getattr(true, name)[1:] for each in found])
        said = np.array([getattr(each, name)[1:] for each in found])
        np.testing.assert_allclose(np.sqrt(np.mean((off / said) ** 2, axis=0)), 1.0, atol=0.3)
        assert np.mean(np.abs(off) < 1.96 * said) == pytest.approx(0.95, abs=0.05)


def test_several_records_weigh_as_one() -> None:
    """Each with an initial state of its own: what they say of a mode adds up."""
    system = order_7()
    records = [system.record(2500, seed=seed) for seed in range(4)]
    drives, responses = ([record[side][700:] for record in records] for side in (0, 1))
    together = refine(system.model, drives, responses).errors.frequency[1:] ** -2
    apart = [refine(system.model, u, y).errors.frequency[1:] ** -2 for u, y in zip(drives, responses, strict=True)]
    np.testing.assert_allclose(together, np.sum(apart, axis=0), rtol=0.3)


def test_the_free_run_is_fitted_where_that_is_asked_for() -> None:
    """A model of too low an order: the free run is better, the prediction worse, than by the other focus."""
    system = order_7()
    drive, response = system.record(SAMPLES, seed=3)
    keep = slice(0, 4)
    low = replace(
        system.model,
        A=system.model.A[keep, keep],
        B=system.model.B[keep],
        C=system.model.C[:, keep],
        K=system.model.K[keep],
    )
    fits = {
        focus: fit(refine(low, drive, response, focus=focus).model, [drive], [response])  # type: ignore[arg-type]
        for focus in ("prediction", "simulation")
    }
    assert fits["simulation"].free_run.nrmse > fits["prediction"].free_run.nrmse + 1
    assert fits["prediction"].one_step.nrmse > fits["simulation"].one_step.nrmse + 1


@pytest.mark.slow
def test_free_run_errors_are_honest_under_coloured_noise() -> None:
    """Within a third, where the inverse of the Hessian would say less than half of it."""
    system = order_7()
    true = system.model.modes
    found = [refine(system.model, *system.record(SAMPLES, seed=200 + k), focus="simulation").errors for k in range(25)]
    for name in ("frequency", "damping"):
        off = np.array([getattr(each.modes, name)[1:] - getattr(true, name)[1:] for each in found])
        said = np.array([getattr(each, name)[1:] for each in found])
        ratio = np.sqrt(np.mean(off**2, axis=0) / np.mean(said**2, axis=0))
        assert 0.75 < ratio.mean() < 1.35


def test_the_gain_after_the_free_run_predicts_as_well_as_the_truth() -> None:
    system = order_7()
    found = refine(spoiled(system.model), *system.record(SAMPLES, seed=4), focus="simulation")
    fresh = system.record(SAMPLES, seed=5)
    best, reached = (fit(model, *([part] for part in fresh)) for model in (system.model, found.model))
    assert reached.one_step.nrmse > best.one_step.nrmse - 0.1


def test_it_stays_stable_where_the_data_grow() -> None:
    """A drifting record draws a pole towards the unit circle and beyond."""
    system = order_7()
    drive, response = system.record(3000, seed=6)
    drift = np.exp(np.arange(3000) / 400)[:, None]
    found = refine(system.model, drive, response + drift, iterations=60).model
    assert found.is_stable
    assert np.abs(np.linalg.eigvals(found.A - found.K @ found.C)).max() < 1
    assert np.abs(found.poles).max() > 0.999
    again = refine(found, drive, response + drift, iterations=5, focus="simulation").model
    assert again.is_stable
    assert np.abs(again.K).max() > 0


def test_states_of_wildly_unlike_sizes_make_no_difference() -> None:
    system = order_7()
    record = system.record(2000, seed=13)
    sizes = np.diag(10.0 ** np.arange(-8, 6, 2))
    a, b = np.linalg.solve(sizes, system.model.A @ sizes), np.linalg.solve(sizes, system.model.B)
    uneven = replace(system.model, A=a, B=b, C=system.model.C @ sizes, K=np.linalg.solve(sizes, system.model.K))
    plain, found = refine(system.model, *record), refine(uneven, *record)
    np.testing.assert_allclose(found.errors.modes.damping, plain.errors.modes.damping, rtol=1e-5)


def test_noiseless_records_are_met_to_rounding() -> None:
    system = order_7()
    drive, response = system.record(2000, seed=7, noise=0.0)
    still = replace(system.model, K=0.1 * system.model.K)
    found = refine(spoiled(still), drive, response).model
    assert fit(found, [drive], [response]).free_run.nrmse > 99.99


def test_units_make_no_difference() -> None:
    system = order_9()
    drive, response = system.record(3000, seed=8)
    plain = refine(system.model, drive, response)
    scale = np.array([1e-6, 1.0, 1e3])
    other = replace(
        system.model,
        C=scale[:, None] * system.model.C,
        K=system.model.K / scale,
        innovation=system.model.innovation * np.outer(scale, scale),
    )
    scaled = refine(other, drive, response * scale)
    np.testing.assert_allclose(scaled.errors.modes.damping, plain.errors.modes.damping, rtol=1e-4)
    np.testing.assert_allclose(scaled.errors.damping[1:], plain.errors.damping[1:], rtol=1e-4)


def test_chunks_make_no_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    system = order_7()
    record = system.record(1000, seed=9)
    whole = refine(system.model, *record)
    monkeypatch.setattr("calibration.prediction_error.normal_equations.CHUNK", 1)
    np.testing.assert_allclose(refine(system.model, *record).model.poles, whole.model.poles, rtol=1e-6)


def test_a_direct_path_is_fitted_or_left_out() -> None:
    system = order_7()
    drive, response = system.record(4000, seed=10)
    with_path = refine(system.model, drive, response + 0.5 * drive).model
    assert with_path.D[0, 0] == pytest.approx(0.5, abs=0.01)
    assert refine(system.model, drive, response, direct=False).model.D[0, 0] == 0.0


def test_the_innovation_is_what_predictions_miss_by() -> None:
    system = order_7()
    found = refine(system.model, *system.record(SAMPLES, seed=11)).model
    assert found.innovation[0, 0] == pytest.approx(system.model.innovation[0, 0], rel=0.05)


def test_an_unstable_start_and_wrong_sizes_are_refused() -> None:
    system = order_7()
    record = system.record(500, seed=12)
    with pytest.raises(ValueError, match="largest pole of A has modulus"):
        refine(replace(system.model, A=1.01 * system.model.A), *record)
    with pytest.raises(ValueError, match="records have"):
        refine(order_9().model, *record)
    with pytest.raises(ValueError, match="focus is"):
        refine(system.model, *record, focus="both")  # type: ignore[arg-type]


def test_scales_are_the_channels_sizes() -> None:
    scale = scale_of([np.array([[3.0, 0.0], [4.0, 0.0]])], [np.ones((2, 1))])
    np.testing.assert_allclose(scale.drive, [np.sqrt(12.5), 1.0])


def test_it_ends_in_time_and_says_how_far_it_came() -> None:
    system, told = order_9(), []
    record = system.record(SAMPLES, seed=4)
    found = refine(spoiled(system.model), *record, seconds=1e-9, show=lambda number, gain: told.append((number, gain)))
    assert not found.arrived
    assert found.iterations == len(told) == 0
    assert found.model.is_stable
    whole = refine(spoiled(system.model), *record, show=lambda number, gain: told.append((number, gain)))
    assert whole.arrived
    assert [number for number, _ in told] == list(range(1, whole.iterations + 1))
    assert max(gain for _, gain in told) > 0.0
    with pytest.raises(ValueError, match="seconds is 0 s, must be > 0"):
        refine(system.model, *record, seconds=0.0)
