"""NRMSE, VAF, MAE, and the fit of a model to records."""

import numpy as np
import pytest

from calibration.fit_measures import fit, mae, measures, nrmse, vaf
from tests.calibration.resonant_systems import order_7, order_9


def test_a_perfect_model_has_all_of_it() -> None:
    response = np.random.default_rng(1).standard_normal((50, 2))
    found = measures(response, response)
    assert np.all(found.nrmse == 100)
    assert np.all(found.vaf == 100)
    assert np.all(found.mae == 0)


def test_the_mean_has_none_of_it_and_each_output_is_measured_apart() -> None:
    response = np.random.default_rng(2).standard_normal((50, 2)) + [5.0, 0.0]
    modelled = np.stack([np.full(50, response[:, 0].mean()), response[:, 1]], axis=1)
    np.testing.assert_allclose(nrmse(response, modelled), [0.0, 100.0], atol=1e-12)


def test_a_constant_error_counts_in_nrmse_and_mae_but_not_in_vaf() -> None:
    response = np.random.default_rng(3).standard_normal((50, 1))
    np.testing.assert_allclose(vaf(response, response + 0.5), 100.0)
    np.testing.assert_allclose(mae(response, response + 0.5), 0.5)
    np.testing.assert_allclose(nrmse(response, response + 0.5), 100 * (1 - 0.5 / response.std()))


def test_an_output_that_never_moves_is_not_divided_by() -> None:
    still = np.ones((4, 1))
    assert nrmse(still, still) == 100
    assert nrmse(still, still + 1) == -np.inf


def test_the_true_model_leaves_white_residuals_that_know_nothing_of_the_drive() -> None:
    system = order_9()
    drive, response = system.record(4000, seed=4)
    found = fit(system.model, [drive], [response])
    assert np.all(np.abs(found.free_run.nrmse - 90) < 2)
    assert np.all(found.one_step.nrmse > found.free_run.nrmse)
    assert found.whiteness.probability > 0.01
    assert found.whiteness.outside < 0.04
    assert found.cross_correlation.outside < 0.04


def test_two_records_are_measured_as_one_each_from_its_own_start() -> None:
    system = order_7()
    drive, response = system.record(3000, seed=5)
    halves = fit(system.model, [drive[:1500], drive[1500:]], [response[:1500], response[1500:]])
    whole = fit(system.model, [drive], [response])
    np.testing.assert_allclose(halves.one_step.nrmse, whole.one_step.nrmse, atol=0.1)
    np.testing.assert_allclose(halves.whiteness.correlation, whole.whiteness.correlation, atol=0.02)


def test_as_many_responses_as_drives_are_wanted() -> None:
    system = order_7()
    drive, response = system.record(100, seed=6)
    with pytest.raises(ValueError, match="zip"):
        fit(system.model, [drive, drive], [response])
