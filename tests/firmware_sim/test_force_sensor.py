"""The simulated force sensor: what it makes of a wrench, and what goes wrong with it."""

from typing import Any

import numpy as np
import pytest

from firmware_sim.plants.force_sensor import ERROR, GAGE_OUT_OF_RANGE, ForceSensorPlant

RATE = 2_000.0
EXACT = {"noise": 0.0, "moment_noise": 0.0, "bias": 0.0, "moment_bias": 0.0, "drift": 0.0, "crosstalk": 0.0}


def sense(wrench: np.ndarray, **options: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    measured, sample, status = np.empty((len(wrench), 6)), *np.empty((2, len(wrench), 1))
    ForceSensorPlant(RATE, **options).run(wrench, measured, sample, status)
    return measured, sample[:, 0], status[:, 0].astype(np.int64)


def test_an_exact_one_shows_a_steady_wrench_at_its_own_rate() -> None:
    wrench = np.tile([10.0, -20.0, 30.0, 1.0, -2.0, 3.0], (400, 1))
    measured, sample, status = sense(wrench, **EXACT)
    np.testing.assert_allclose(measured[-1], wrench[-1], rtol=1e-6)
    np.testing.assert_array_equal(sample, 1 + np.arange(400) // 4)
    assert status.max() == 0


def test_bias_noise_drift_and_crosstalk_have_their_sizes() -> None:
    nothing = np.zeros((int(60 * RATE), 6))
    measured = sense(nothing, seed=3)[0][::4]
    np.testing.assert_allclose(measured[:500].std(axis=0), [0.15] * 3 + [0.01] * 3, rtol=0.15)
    drift = np.abs(measured[-500:].mean(axis=0) - measured[:500].mean(axis=0))
    np.testing.assert_allclose(drift, [0.3] * 3 + [0.03] * 3, rtol=0.1)
    biases = np.array([sense(nothing[:4], seed=seed)[0][0] for seed in range(60)])
    np.testing.assert_allclose(biases.std(axis=0), [5.0] * 3 + [0.5] * 3, rtol=0.3)
    pushed = np.zeros((400, 6))
    pushed[:, 0] = 100.0
    others = [sense(pushed, **EXACT | {"crosstalk": 0.005, "seed": seed})[0][-1, 1] for seed in range(40)]
    assert 0.3 < np.std(others) < 0.8


def test_teeth_are_filtered() -> None:
    time = np.arange(4_000) / RATE
    wrench = np.zeros((4_000, 6))
    wrench[:, 0] = np.sin(2 * np.pi * 600.0 * time)
    measured = sense(wrench, **EXACT | {"sample_rate": 2_000.0})[0][1_000:, 0]
    assert 0.02 < measured.std() / np.sqrt(0.5) < 0.15


def test_it_saturates_and_says_so() -> None:
    wrench = np.zeros((400, 6))
    wrench[:, 1] = -500.0
    measured, _, status = sense(wrench)
    assert measured[-1, 1] == -400.0
    assert status[-1] == GAGE_OUT_OF_RANGE | ERROR
    assert sense(np.tile([0, 0, 700.0, 0, 0, 0], (400, 1)))[2].max() == 0  # twice the range along its axis


def test_it_is_silent_stuck_and_jumps_when_it_is_told_to() -> None:
    nothing = np.zeros((2_000, 6))
    sample = sense(nothing, silent=0.2, silent_for=0.3)[1]
    assert np.ptp(sample[400:1_000]) == 0.0
    assert sample[1_004] - sample[399] > 100  # its counter goes on
    status = sense(nothing, stuck=0.2, stuck_for=0.1)[2]
    assert status[:400].max() == 0 < status[400:600].min()
    assert status[604:].max() == 0
    measured = sense(nothing, **EXACT | {"step_at": 0.5, "step": 20.0})[0]
    np.testing.assert_allclose(measured[[999, -1], 1], [0.0, 20.0])


def test_options_out_of_range_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match="simulator.options.noise is -1"):
        ForceSensorPlant(RATE, noise=-1.0)
    with pytest.raises(ValueError, match="rate is 100.0 samples/s, must be 500 to"):
        ForceSensorPlant(100.0)
