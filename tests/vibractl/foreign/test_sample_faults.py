"""Clipping, dropouts and dead channels are found in samples of every kind, and nothing is found in sound ones."""

import numpy as np
import pytest

from vibractl.foreign.sample_faults import SampleFaults

RATE = 44_100
TIME = np.arange(4 * RATE) / RATE
SWEEP = np.sin(2 * np.pi * (40 * TIME + 5 * TIME**2)) * ((TIME > 0.2) & (TIME < 3.5))
NOISE = np.random.default_rng(0).standard_normal(len(TIME))


def rounded(signal: np.ndarray, bits: int) -> np.ndarray:
    return np.round(signal * 2 ** (bits - 1)) / 2 ** (bits - 1)


KINDS = {
    "float": 0.5 * SWEEP,
    "16 bits": rounded(0.5 * SWEEP, 16),
    "16 bits, faint": rounded(0.005 * SWEEP, 16),
    "noisy": 0.5 * SWEEP + 1e-2 * NOISE,
    "16 bits, faint and noisy": rounded(0.005 * SWEEP + 3e-5 * NOISE, 16),
}
kinds = pytest.mark.parametrize("kind", KINDS)


def found(signal: np.ndarray, full_scale: float = 1.0, block: int = 2**16) -> list[tuple[str, int, int]]:
    """Return what is found in a channel beside a sound one."""
    faults = SampleFaults(np.full(2, full_scale))
    both = np.stack((signal, KINDS["noisy"]), axis=1)
    for first in range(0, len(both), block):
        faults.follow(both[first : first + block])
    every = faults.end()
    assert all(each.channel == 0 for each in every)
    return [(each.kind, each.first, each.end) for each in every]


@kinds
@pytest.mark.parametrize("block", [2**16, 1_000])
def test_nothing_is_found_in_a_sound_signal(kind: str, block: int) -> None:
    assert found(KINDS[kind], block=block) == []


@kinds
@pytest.mark.parametrize("samples", [16, 500, 3_000, 20_000])
@pytest.mark.parametrize("block", [2**16, 1_000])
def test_zeros_amid_a_signal_are_a_dropout(kind: str, samples: int, block: int) -> None:
    signal = KINDS[kind].copy()
    signal[80_017 : 80_017 + samples] = 0.0
    ((what, first, end),) = found(signal, block=block)
    assert what == "dropout"
    assert (abs(first - 80_017), abs(end - 80_017 - samples)) <= (40, 40)  # faint ones stay at 0 for some samples


@pytest.mark.parametrize("kind", ["float", "16 bits", "noisy"])
def test_a_value_that_is_held_is_a_dropout(kind: str) -> None:
    signal = KINDS[kind].copy()
    signal[80_017:80_117] = signal[80_017]
    assert found(signal) == [("dropout", 80_017, 80_117)]


@kinds
def test_a_channel_that_stays_at_its_largest_value_is_clipped(kind: str) -> None:
    limit = 0.7 * np.abs(KINDS[kind]).max()
    every = found(np.clip(KINDS[kind], -limit, limit))
    assert len(every) > 20
    assert {what for what, _, _ in every} == {"clipped"}
    assert min(first for _, first, _ in every) < RATE


def test_a_single_sample_at_full_scale_is_clipped_where_full_scale_is_known() -> None:
    signal = KINDS["noisy"].copy()
    signal[70_000] = -1.0
    assert found(signal) == [("clipped", 70_000, 70_001)]
    assert found(signal, full_scale=np.inf) == []


def test_a_channel_with_one_value_is_dead() -> None:
    faults = SampleFaults(np.full(2, np.inf))
    faults.follow(np.stack((np.full(RATE, 0.25), SWEEP[:RATE]), axis=1))
    assert faults.dead.tolist() == [True, False]
