"""Signals that are cut off, and vibrations of all kinds that are not."""

import numpy as np
import pytest

from vibractl.flat_tops import flat_top

RATE = 44_100
TIME = np.arange(3 * RATE) / RATE
TONE = np.sin(2 * np.pi * 40 * TIME)
SWEEP = np.sin(2 * np.pi * (30 + 10 * TIME) * TIME)
THIRD, FIFTH = np.sin(2 * np.pi * 120 * TIME), np.sin(2 * np.pi * 200 * TIME)
FLATTEST = {"third overtone": TONE + THIRD / 9, "square as far as its fifth": TONE + THIRD / 3 + FIFTH / 5}
SIGNALS = {
    "tone": TONE,
    "sweep": SWEEP,
    "sweep that grows and shrinks": SWEEP * (1 + 0.5 * np.sin(2 * np.pi * 0.7 * TIME)),
    "sweep on gravity": SWEEP + 9.81,
    "soft saturation": np.tanh(2 * TONE),
    "multisine": sum(np.sin(2 * np.pi * f * TIME + f**2) for f in range(40, 90)),
    **FLATTEST,
}


def noise(size: float) -> np.ndarray:
    return size * np.random.default_rng(3).standard_normal(len(TIME))


@pytest.mark.parametrize("level", [0.0, 1e-4, 1e-2, 0.3])
@pytest.mark.parametrize("name", SIGNALS)
def test_vibrations_have_no_flat_tops_whatever_noise_is_on_them(name: str, level: float) -> None:
    assert flat_top(SIGNALS[name] + noise(level)) is None


@pytest.mark.parametrize("level", [0.0, 1e-4, 2e-3])
@pytest.mark.parametrize("name", ["tone", "sweep", "soft saturation", "third overtone"])
def test_what_is_cut_off_ten_per_cent_below_its_peak_is_found(name: str, level: float) -> None:
    signal = SIGNALS[name]
    edge = 0.9 * float(signal.max())
    found = flat_top(np.minimum(signal, edge) + noise(level))
    assert found is not None
    value, count = found
    assert value == pytest.approx(edge, rel=0.01)
    assert count > 100


def test_the_lower_side_is_looked_at_too() -> None:
    found = flat_top(np.maximum(TONE, -0.8))
    assert found == (pytest.approx(-0.8), 120)


def test_a_signal_at_rest_or_very_short_has_none() -> None:
    assert flat_top(np.zeros(1000)) is None
    assert flat_top(np.zeros(3)) is None
    assert flat_top(noise(1.0)) is None
