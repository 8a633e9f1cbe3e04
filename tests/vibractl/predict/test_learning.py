"""Simulated runs: how many shots they take, and when they never get there."""

from dataclasses import replace

import numpy as np
import pytest

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.predict.learning import HELD, Forecast, forecast
from vibractl.setup import Setup, judged_lines, setup

RUNS = 4


def made_with(*overrides: str, deviation: float = 1e-3) -> Setup:
    matrix = linear_matrix()
    matrix = replace(matrix, variance=deviation**2 * np.abs(matrix.response) ** 2)
    return setup(linear_config("session.shots=25", *overrides), matrix)


def runs(made: Setup) -> Forecast:
    return forecast(made, RUNS, lambda _: None)


def test_the_objective_is_met_and_a_run_ends_when_it_has_held() -> None:
    found = runs(made_with("learning.gains=[0.8]"))
    assert np.isfinite(found.met).all()
    for run, met in enumerate(found.met.astype(int)):
        assert found.worst[met - 1, run] > 0
        assert np.all(found.worst[met : met + HELD, run] <= 0)
        assert np.isnan(found.worst[met + HELD :, run]).all()


@pytest.mark.slow
def test_a_small_gain_takes_more_shots_and_a_tiny_one_never_gets_there() -> None:
    fast, slow, never = (runs(made_with(f"learning.gains=[{gain}]")) for gain in (0.8, 0.3, 0.001))
    assert fast.quantile(0.5) < slow.quantile(0.5) < np.inf
    assert np.isinf(never.met).all()
    assert never.quantile(0.1) == np.inf


def test_a_run_that_begins_faint_meets_it_when_it_is_at_full_level() -> None:
    found = runs(made_with("learning.gains=[0.8]", "learning.quiet=true"))
    assert found.worst[0] == pytest.approx(34.0, abs=0.1)  # dB that are missing, whatever the first shot emits
    assert np.all(found.met >= 6)


@pytest.mark.slow
def test_an_uncertain_model_takes_more_shots() -> None:
    sure, unsure = (runs(made_with("learning.gains=[0.8]", deviation=each)) for each in (1e-3, 0.25))
    assert sure.quantile(0.5) < unsure.quantile(0.5)


def test_the_law_is_the_one_configured() -> None:
    thesis, kalman = (runs(made_with(f"learning.law={law}", "learning.gains=[]")) for law in ("thesis", "kalman"))
    assert kalman.quantile(0.5) < thesis.quantile(0.5) / 2


def test_a_sine_is_judged_at_its_overtones_alone() -> None:
    made = made_with("reference.signal=sine:50:1")
    np.testing.assert_allclose(
        made.law.matrix.frequency[judged_lines(made.law, made.reference, made.config)], [100, 150, 200, 250]
    )


def test_a_sine_whose_edges_are_not_looked_at_is_learned_like_a_chirp() -> None:
    found = runs(made_with("reference.signal=sine:50:1", "learning.law=kalman", "learning.gains=[]"))
    assert found.quantile(0.5) < 10


def test_a_part_of_the_runs_is_done_by_its_quantile() -> None:
    met = np.append(np.arange(18.0), [np.inf, np.inf])
    found = Forecast(met, np.zeros((30, 20)), np.zeros(20), np.zeros((20, 1, 1), complex))
    assert [found.quantile(part) for part in (0.1, 0.5, 0.9, 0.95)] == [1.0, 9.0, 17.0, np.inf]
