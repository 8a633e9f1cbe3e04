"""Horizon and order, chosen by what was held out."""

import warnings

import numpy as np
import pytest

from calibration import subspace
from calibration.subspace.trial import SURE, Trial, smallest
from calibration.subspace.windows import Layout
from tests.calibration.resonant_systems import RATE, order_7, order_9

NEAR = 0.01


def trial(order: int, score: float, stands_out: bool = True, horizon: int = 20) -> Trial:
    """Return one of a single output whose errors are both exp(-score / 2)."""
    power = {0: np.array([np.exp(-score)])}
    return Trial(Layout(horizon, horizon, 1, 1), order, stands_out, power, dict(power))


def test_a_smaller_order_is_taken_where_it_is_as_good() -> None:
    assert smallest([trial(4, 2.0), trial(7, 3.0), trial(9, 3.0 + NEAR / 2)], NEAR).order == 7
    assert smallest([trial(4, 2.0), trial(7, 3.0), trial(9, 3.0 + 2 * NEAR)], NEAR).order == 9


def test_of_an_order_the_best_horizon_is_taken() -> None:
    assert smallest([trial(7, 3.0, horizon=20), trial(7, 3.1, horizon=40)], NEAR).layout.future == 40


def test_what_does_not_stand_out_of_the_noise_must_be_much_better() -> None:
    seen = [trial(3, 2.0), trial(5, 2.0 + NEAR / 2)]
    assert smallest([*seen, trial(8, 2.0 + 0.9 * SURE, stands_out=False)], NEAR).order == 3
    assert smallest([*seen, trial(8, 2.0 + 1.1 * SURE, stands_out=False)], NEAR).order == 8


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.slow
def test_order_and_horizon_are_found_together(seed: int) -> None:
    for system in (order_7(), order_9()):
        found = subspace.identify(*system.record(2500, seed=40 + seed), RATE)
        assert found.model.order == system.model.order
        tried = {(each.order, each.horizon) for each in found.candidates}
        assert (found.model.order, found.horizon[0]) in tried
        assert len({horizon for _, horizon in tried}) >= 3


def test_a_record_that_is_too_short_for_its_order_is_told_of() -> None:
    record = order_7().record(120, seed=1)
    with pytest.warns(UserWarning, match="120 samples are few: orders beyond 4 were not tried"):
        assert subspace.identify(*record, RATE).model.order <= 4


@pytest.mark.slow
def test_a_model_of_a_short_record_is_worth_something_on_a_fresh_one() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fits = [
            subspace.identify(*order_7().record(400, seed), RATE)
            .compare(*order_7().record(4000, 100 + seed))
            .fit.free_run
            for seed in range(2)
        ]
    assert min(each.nrmse[0] for each in fits) > 75
