"""The simulated macro and micro manipulator."""

import numpy as np
import pytest

from firmware_sim.plants.macro_micro import MacroMicroOptions, MacroMicroPlant

RATE = 250.0


def _run(fast: np.ndarray, slow: np.ndarray, **options: object) -> dict[str, np.ndarray]:
    signals = {name: np.zeros((len(fast), 1)) for name in ("relative", "fast", "slow", "control", "position")}
    MacroMicroPlant(RATE, **options).run(fast[:, None], slow[:, None], *signals.values())
    return {name: signal[:, 0] for name, signal in signals.items()}


def test_both_loops_answer_a_step_as_3_13_says() -> None:
    fast, slow = np.full(500, 1e-3), np.full(500, 1e-3)
    seen, n = _run(fast, slow), np.arange(1, 501)
    np.testing.assert_allclose(seen["fast"], 1e-3 * (1.0 - 0.96**n), rtol=1e-12)
    np.testing.assert_allclose(seen["slow"], 1e-3 * (1.0 - np.exp(-0.004 * n)), rtol=1e-12)
    np.testing.assert_allclose(seen["relative"], seen["fast"] + seen["slow"], rtol=1e-15)


def test_the_inner_control_signal_saturates_and_is_shown_ahead_of_it() -> None:
    seen = _run(np.full(100, 5e-3), np.zeros(100))
    assert seen["control"][0] == pytest.approx(25e-3)
    assert np.diff(seen["fast"]).max() == pytest.approx(2.0 * 10e-3 / RATE)


def test_a_gain_changes_at_its_sample() -> None:
    seen = _run(np.full(100, 1e-3), np.zeros(100), gains=((0.2, 1.5),))
    ratio = np.diff(seen["fast"]) / seen["control"][1:]
    np.testing.assert_allclose(ratio[:49], 0.008, rtol=1e-9)
    np.testing.assert_allclose(ratio[49:], 0.012, rtol=1e-9)


def test_a_disturbance_moves_the_relative_position_alone() -> None:
    seen = _run(np.zeros(100), np.zeros(100), disturbance=5e-3, disturbed_at=0.2)
    assert list(np.flatnonzero(seen["relative"])) == list(range(49, 100))  # the sample's end is 0.2 s
    assert not seen["fast"].any()
    assert not seen["slow"].any()


def test_noise_is_on_the_sensors_and_not_on_the_position() -> None:
    seen = _run(np.zeros(4000), np.zeros(4000), noise=1e-3)
    assert not seen["position"].any()
    for name in ("relative", "fast", "slow"):
        assert np.std(seen[name]) == pytest.approx(1e-3, rel=0.05)
    assert abs(np.corrcoef(seen["fast"], seen["relative"])[0, 1]) < 0.05


def test_an_option_out_of_range_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"simulator\.options\.limit is 0\.0, must be 1e-09 to 1000 m/s"):
        MacroMicroOptions(limit=0.0)
    with pytest.raises(ValueError, match=r"simulator\.options\.gains has -1\.0 at 2\.0 s, must be > 0 at >= 0 s"):
        MacroMicroOptions(gains=((2.0, -1.0),))
