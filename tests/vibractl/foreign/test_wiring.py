"""Wires are told from what each way of wiring leaves unexplained, and how sure that is."""

import numpy as np
import pytest

from vibractl.foreign.wiring import Wires, confidence, exchange, exchanges, signs, straight, wired, witnesses

RATE = 2_000
TIME = np.arange(2 * RATE) / RATE
FIRST = np.sin(2 * np.pi * (40 * TIME + 12.5 * TIME**2)) * np.hanning(len(TIME))
SECOND = np.sin(2 * np.pi * (60 * TIME + 12.5 * TIME**2)) * np.hanning(len(TIME))
BOTH = np.stack((FIRST, SECOND), axis=1)


def test_a_band_has_a_witness_every_two_hertz() -> None:
    sweep = np.sin(2 * np.pi * (40 * TIME + 12.5 * TIME**2))[:, None]
    assert witnesses(sweep, RATE) == pytest.approx(50 / 2, rel=0.2)


def test_equal_explanations_are_even_and_a_better_one_is_sure() -> None:
    assert confidence(0.9, 0.9, 25.0) == 0.5
    assert confidence(0.99, 0.9, 25.0) > 0.999
    assert 0.5 < confidence(0.901, 0.9, 25.0) < 0.6
    assert confidence(1.0, 0.0, 1e6) == 1.0


def test_polarity_is_told_wherever_the_signal_lies() -> None:
    heard = np.pad(BOTH * [2.0, -3.0], ((500, 300), (0, 0)))
    upright, inverted = signs(BOTH, heard, 25.0)
    assert (upright.is_inverted, inverted.is_inverted) == (False, True)
    assert upright.is_sure
    assert inverted.is_sure
    assert inverted.correlation == pytest.approx(-1.0)


def likeness(true: np.ndarray, drives: Wires, responses: Wires) -> float:
    """Return how like the responses of a known system of two are to what is expected of its drives."""
    mixing = np.array([[1.0, 0.6], [-0.2, 0.8]])
    expected = wired(BOTH, drives) @ mixing
    heard = wired(true @ mixing, responses)
    sizes = np.sqrt((expected**2).sum(axis=0) * (heard**2).sum(axis=0))
    return float(np.sqrt(np.mean(((expected * heard).sum(axis=0) / sizes) ** 2)))


@pytest.mark.parametrize("wires", [((0, 1), (1, 1)), ((1, 1), (0, 1)), ((0, 1), (1, -1)), ((1, 1), (0, -1))])
def test_drives_are_told_apart_by_what_is_heard_of_them(wires: Wires) -> None:
    true = wired(BOTH, wires)
    drives, responses = exchanges(lambda one, other: likeness(true, one, other), 2, 2, 25.0)
    assert drives.wires == wires
    assert drives.is_sure
    assert not responses.is_other
    assert drives.is_other == (wires != straight(2))


def test_what_is_alike_cannot_be_told() -> None:
    found = exchange(lambda _: 0.9, 3, 25.0)
    assert (found.is_other, found.is_sure, found.confidence) == (False, False, 0.5)
