"""Signals that repeat themselves exactly, and others."""

import warnings

import numpy as np
import pytest

from calibration.gaps import without_gaps
from calibration.subspace import feedback as feedback_module
from calibration.subspace.feedback import feedback
from calibration.subspace.periodic import periodic
from firmware_sim.population.signals import SYSTEMS, signal


@pytest.mark.parametrize("count", [1.5, 2.0, 7.3])
def test_a_multisine_of_any_number_of_periods_repeats_itself(count: float) -> None:
    one = np.random.default_rng(1).standard_normal((200, 2))
    whole = np.tile(one, (8, 1))[: int(200 * count)]
    assert periodic([whole]).all()
    assert periodic([whole, whole[30:90], 3.0 * whole[17:]]).all()


def test_one_that_was_measured_or_lasts_less_than_two_periods_does_not() -> None:
    rng = np.random.default_rng(2)
    whole = np.tile(rng.standard_normal((200, 1)), (5, 1))
    assert not periodic([whole + 1e-3 * rng.standard_normal(whole.shape)]).any()
    assert not periodic([whole[:240]]).any()
    assert not periodic([rng.standard_normal((1000, 1))]).any()


def test_steps_ramps_and_nothing_do_not() -> None:
    rng = np.random.default_rng(3)
    steps = np.repeat(rng.standard_normal(10), 50)
    assert not periodic([np.column_stack([steps, np.arange(500.0), np.zeros(500)])]).any()


def test_rest_at_both_ends_is_no_period() -> None:
    """A controller that is switched on for a while, and a knock."""
    rng = np.random.default_rng(8)
    while_on, knock = np.zeros((2, 4000, 1))
    while_on[1050:2950] = rng.standard_normal((1900, 1))
    knock[2000] = 1.0
    assert not periodic([while_on]).any()
    assert not periodic([knock]).any()


def test_a_level_hides_no_difference() -> None:
    assert not periodic([1e6 + np.random.default_rng(9).standard_normal((1000, 1))]).any()


@pytest.mark.parametrize("seed", [4185, 4241])
def test_a_periodic_input_is_in_no_loop_whatever_the_outputs_seem_to_tell(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Drawn multisines with trends: what an ARX model leaves goes with them."""
    record = signal(list(SYSTEMS)[seed % len(SYSTEMS)], seed).record()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pieces = without_gaps([record.given], [record.measured])
    drives, responses = ([each - np.concatenate(of).mean(axis=0) for each in of] for of in pieces)
    assert feedback(drives, responses).inputs == ()
    monkeypatch.setattr(feedback_module, "periodic", lambda drives: np.zeros(drives[0].shape[1], bool))
    assert feedback(drives, responses).inputs != ()
