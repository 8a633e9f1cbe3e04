"""Models cut to fewer states: a start as good as another for a refinement, and stable."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from calibration.fit_measures import fit
from calibration.prediction_error import arx, reduced, refine
from tests.calibration.resonant_systems import order_7, order_9


def test_from_an_arx_model_a_refinement_reaches_the_truth() -> None:
    """No subspace step in between."""
    system = order_9()
    record = system.record(6000, seed=1)
    start = reduced(arx(*record, 1000.0, 30).model(), 9)
    found = refine(start, *record).model
    fresh = system.record(6000, seed=2)
    best, reached = (fit(model, *([part] for part in fresh)) for model in (system.model, found))
    assert reached.one_step.nrmse.mean() > best.one_step.nrmse.mean() - 0.05
    assert reached.free_run.nrmse.mean() > best.free_run.nrmse.mean() - 0.2


def test_to_its_own_order_a_model_stays_what_it_is() -> None:
    model = order_7().model
    np.testing.assert_allclose(np.sort_complex(reduced(model, 7).poles), np.sort_complex(model.poles), atol=1e-8)


def test_what_grows_is_brought_inside() -> None:
    model = order_7().model
    growing = replace(model, A=1.02 * model.A)
    covariance = solve_discrete_are(growing.A.T, growing.C.T, np.eye(7), np.eye(1))
    spread = growing.C @ covariance @ growing.C.T + np.eye(1)
    watched = replace(growing, K=growing.A @ covariance @ growing.C.T / spread)
    found = reduced(watched, 5)
    assert found.is_stable
    assert np.abs(np.linalg.eigvals(found.A - found.K @ found.C)).max() < 1


def test_orders_and_predictors_that_cannot_be_are_refused() -> None:
    model = order_7().model
    with pytest.raises(ValueError, match="order is 8, must be 1 to the model's 7"):
        reduced(model, 8)
    with pytest.raises(ValueError, match="largest pole of A - K C"):
        reduced(replace(model, A=1.02 * model.A, K=0 * model.K), 5)
