"""The generalized Prandtl-Ishlinskii model, its inverse, its block and its file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFileError
from stagectl.stage.hysteresis import HysteresisModel, invert, respond
from stagectl.stage.hysteresis_compensation import HysteresisCompensation
from stagectl.stage.hysteresis_file import read_hysteresis, write_hysteresis

RATE = 1_000.0
PLAIN = HysteresisModel(
    0.0, 100.0, np.array([0.0, 1e-6, 0.0, 0.0]), np.zeros(2), np.zeros(2), np.array([0.5]), np.array([1e-6]), RATE
)
SKEWED = HysteresisModel(
    0.0,
    1000.0,
    np.array([50e-6, 30e-6, -2e-6, 1e-6]),
    np.array([-0.2, 0.05]),
    np.array([0.1, 0.1]),
    np.linspace(0.05, 0.9, 12),
    np.linspace(4e-6, 1e-6, 12),
    RATE,
)

CROSSED = replace(SKEWED, rising=SKEWED.falling, falling=SKEWED.rising)


def _wandering(low: float, high: float, samples: int = 5_000, seed: int = 2) -> np.ndarray:
    """Return a signal with many turning points of every size between two levels, shape (samples,)."""
    time = np.arange(samples) / RATE
    rng = np.random.default_rng(seed)
    wave = sum(np.sin(2 * np.pi * f * time + rng.uniform(0, 6)) / (1 + f) for f in (0.7, 1.9, 4.3, 11.0))
    wave = (wave - np.min(wave)) / np.ptp(wave)
    return low + (high - low) * wave


def test_one_play_follows_a_hand_calculation() -> None:
    """With x at 0, 1, 0, -1, 0 the play of threshold 0.5 goes 0, 0.5, 0.5, -0.5, -0.5."""
    voltage = np.array([50.0, 100.0, 50.0, 0.0, 50.0])
    np.testing.assert_allclose(respond(PLAIN, voltage) * 1e6, [0, 1.5, 0.5, -1.5, -0.5], atol=1e-12)


def test_without_its_plays_it_is_its_cubic() -> None:
    model = replace(SKEWED, weights=np.zeros(12))
    x = np.linspace(-1, 1, 50)
    expected = 1e-6 * (50 + 30 * x - 2 * x**2 + x**3)
    np.testing.assert_allclose(respond(model, 500 + 500 * x), expected, rtol=1e-12)


def test_a_minor_loop_returns_to_the_major_one() -> None:
    """Return-point memory, which every model of this kind has."""
    up = np.linspace(0, 900, 200)
    detour = np.concatenate([np.linspace(900, 600, 50), np.linspace(600, 900, 50)])
    on = np.linspace(900, 1000, 20)
    straight = respond(SKEWED, np.concatenate([up, on]), start=0.0)
    round_about = respond(SKEWED, np.concatenate([up, detour, on]), start=0.0)
    np.testing.assert_allclose(round_about[-20:], straight[-20:], rtol=0, atol=1e-18)


def test_the_inverse_gives_back_the_response_exactly() -> None:
    wanted = _wandering(10e-6, 90e-6)
    voltage = invert(SKEWED, wanted)
    assert 0 < voltage.min() < voltage.max() < 1000
    np.testing.assert_allclose(respond(SKEWED, voltage, start=500.0), wanted, rtol=0, atol=1e-14)


@pytest.mark.parametrize("model", [SKEWED, CROSSED])
def test_the_inverse_gives_back_the_voltage_exactly(model: HysteresisModel) -> None:
    voltage = _wandering(20.0, 980.0)
    np.testing.assert_allclose(invert(model, respond(model, voltage, start=500.0)), voltage, rtol=0, atol=1e-7)


@pytest.mark.parametrize("model", [SKEWED, CROSSED])
def test_a_constant_voltage_moves_nothing(model: HysteresisModel) -> None:
    """Where the envelopes cross by more than a play is wide, the rising one wins before and after."""
    held = np.repeat(_wandering(20.0, 980.0, 50, 4), 3)
    response = respond(model, held, start=500.0).reshape(-1, 3)
    np.testing.assert_allclose(response[:, 1:], response[:, :-1], rtol=0, atol=1e-18)


def test_the_inverse_undoes_the_lag_and_leaves_the_delay() -> None:
    model = replace(SKEWED, lag=3e-3, delay=2)
    wanted = _wandering(20e-6, 80e-6)
    wanted[:20] = wanted[0]
    answer = respond(model, invert(model, wanted), start=500.0)
    np.testing.assert_allclose(answer[2:], wanted[:-2], rtol=0, atol=1e-12)


def test_a_lag_widens_the_loop_with_rate() -> None:
    model = replace(SKEWED, lag=5e-3)
    time = np.arange(4_000) / RATE
    widths = []
    for frequency in (1.0, 10.0):
        answer = respond(model, 500 - 450 * np.cos(2 * np.pi * frequency * time))
        period = round(RATE / frequency)
        widths.append(np.max(answer[-period:][::-1] - answer[-period:]) / np.ptp(answer[-period:]))
    assert widths[1] > 1.2 * widths[0]


def test_beyond_its_reach_the_inverse_stays_at_the_end_of_the_range() -> None:
    voltage = invert(SKEWED, np.array([50e-6, 1.0, 50e-6, -1.0]))
    assert voltage[1] == 1000.0
    assert voltage[3] == 0.0


def test_the_block_makes_a_modelled_stack_straight() -> None:
    """Its loops of a fifth of the span are gone to rounding."""
    block = HysteresisCompensation([SKEWED])
    block.prepare(RATE, 5_000)
    asked, voltage = _wandering(50.0, 950.0)[:, None], np.empty((5_000, 1))
    block.process(asked, voltage)
    low, high = SKEWED.span
    chord = low + (high - low) * asked[:, 0] / 1000
    np.testing.assert_allclose(respond(SKEWED, voltage[:, 0], start=0.0), chord, rtol=0, atol=1e-14)
    assert np.max(np.abs(voltage - asked)) > 30.0


def test_a_channel_without_a_model_passes_bit_for_bit_and_may_be_given_one() -> None:
    block = HysteresisCompensation([None, SKEWED])
    block.prepare(RATE, 100)
    asked = np.random.default_rng(1).uniform(100, 900, (100, 2))
    voltage = np.empty_like(asked)
    block.process(asked, voltage)
    np.testing.assert_array_equal(voltage[:, 0], asked[:, 0])
    block.change([SKEWED, None])
    block.process(asked, voltage)
    np.testing.assert_array_equal(voltage[:, 1], asked[:, 1])
    assert not np.any(voltage[:, 0] == asked[:, 0])


def test_nan_passes_as_nan_and_moves_nothing() -> None:
    block = HysteresisCompensation([SKEWED])
    outputs = []
    for sick in (300.0, np.nan):
        block.prepare(RATE, 3)
        voltage = np.empty((3, 1))
        block.process(np.array([[300.0], [sick], [700.0]]), voltage)
        outputs.append(voltage)
    assert np.isnan(outputs[1][1, 0])
    np.testing.assert_array_equal(outputs[1][[0, 2]], outputs[0][[0, 2]])


def test_a_file_holds_the_model_and_where_it_came_from(tmp_path: Path) -> None:
    path = tmp_path / "x.h5"
    write_hysteresis(path, replace(SKEWED, delay=1, lag=1e-3, provenance={"recording": "x.csv"}))
    back = read_hysteresis(path)
    voltage = _wandering(0.0, 1000.0)
    np.testing.assert_array_equal(respond(back, voltage), respond(replace(SKEWED, delay=1, lag=1e-3), voltage))
    assert back.provenance == {"recording": "x.csv"}
    path.write_bytes(path.read_bytes()[:600])
    with pytest.raises(ModelFileError, match="not a readable model file"):
        read_hysteresis(path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"high": 0.0}, "low is 0.0 and high 0.0 V, must be finite and low < high"),
        ({"cubic": np.zeros(3)}, "cubic is .*, must be 4 finite numbers"),
        ({"cubic": np.array([0, 1e-6, 5e-6, 0])}, "cubic .* has slope .* must be > .* for an inverse"),
        ({"rising": np.array([2.0, 0.0])}, "rising envelope .* has slope -3 at x = -1"),
        ({"weights": np.full(12, -1e-6)}, "weights has -1e-06, must be >= 0"),
        ({"weights": np.ones(3)}, "12 thresholds and 3 weights"),
        ({"delay": 0.5}, "delay is 0.5 samples, must be a whole number >= 0"),
        ({"lag": np.nan}, "lag nan s, must be"),
    ],
)
def test_a_model_that_is_none_is_refused_with_the_reason(change: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        replace(SKEWED, **change)  # type: ignore[arg-type]


def test_samples_that_are_not_finite_are_refused() -> None:
    with pytest.raises(ValueError, match="voltage has shape"):
        respond(SKEWED, np.array([1.0, np.inf]))
