"""Each fault on purpose does what its name says, to its channel alone."""

import numpy as np
import pytest

from rigkit.faults import KINDS, Faults, FaultTable

RATE, FRAMES = 10_000.0, 20_000
NAMES = ("left", "right", "cable")


def made(kind: str, before: int = 100) -> tuple[np.ndarray, np.ndarray]:
    """Return what came in and out, (samples, channels), of which the first has the fault after `before` samples."""
    table = FaultTable(NAMES)
    block = Faults(table, (2.0, 3.0, 1.0))
    clean = np.random.default_rng(3).normal(size=(FRAMES, 3))
    faulty = np.full_like(clean, np.nan)
    block.prepare(RATE, FRAMES)
    block.process(clean[:before], faulty[:before])
    table.inject("left", kind)
    block.process(clean[before:], faulty[before:])
    assert np.array_equal(clean[:before], faulty[:before])
    assert np.array_equal(clean[:, 1:], faulty[:, 1:])
    return clean[before:, 0], faulty[before:, 0]


@pytest.mark.parametrize(("kind", "value"), [("nan", np.nan), ("inf", np.inf), ("zero", 0.0), ("full-scale", 2.0)])
def test_a_sensor_that_says_one_thing(kind: str, value: float) -> None:
    assert np.array_equal(made(kind)[1], np.full(FRAMES - 100, value), equal_nan=True)


def test_a_sensor_that_is_stuck_stays_where_it_was() -> None:
    clean, faulty = made("stuck")
    assert (faulty == clean[0]).all()


@pytest.mark.parametrize(("kind", "factor"), [("x10", 10.0), ("sign-flip", -1.0), ("none", 1.0)])
def test_a_sensor_that_is_scaled(kind: str, factor: float) -> None:
    clean, faulty = made(kind)
    assert np.array_equal(faulty, factor * clean)


def test_a_sensor_that_is_swapped_hears_the_next() -> None:
    table = FaultTable(NAMES)
    table.inject("cable", "swap")
    block = Faults(table, (1.0, 1.0, 1.0))
    block.prepare(RATE, 4)
    faulty = np.zeros((4, 3))
    block.process(np.arange(12.0).reshape(4, 3), faulty)
    assert np.array_equal(faulty[:, 2], faulty[:, 0])


def test_a_delay_is_ten_milliseconds() -> None:
    clean, faulty = made("delay", before=200)
    assert np.array_equal(faulty[100:], clean[:-100])


def test_a_drop_loses_a_sample_in_a_hundred() -> None:
    clean, faulty = made("drop")
    assert np.mean(clean != faulty) == pytest.approx(0.01, abs=0.003)
    lost = np.flatnonzero(clean != faulty)
    assert np.isin(faulty[lost[5:]], clean).all()


def test_a_clock_that_is_slow_slips_by_a_sample_in_ten_thousand() -> None:
    clean, faulty = made("clock")
    assert faulty[9_999] == pytest.approx(clean[9_998], abs=1e-6)
    assert faulty[19_899] == pytest.approx(0.01 * clean[19_898] + 0.99 * clean[19_897], abs=0.1)


def test_a_hum_is_a_hundredth_of_full_scale_at_the_mains() -> None:
    clean, faulty = made("hum")
    lines = np.abs(np.fft.rfft((faulty - clean)[:10_000])) / 5_000
    assert lines[50] == pytest.approx(0.02, rel=1e-9)
    assert np.delete(lines, 50).max() < 1e-12


def test_a_fault_can_be_taken_away_and_begins_anew() -> None:
    table = FaultTable(NAMES)
    block = Faults(table, (1.0, 1.0, 1.0))
    block.prepare(RATE, 10)
    clean, faulty = np.arange(30.0).reshape(10, 3), np.zeros((10, 3))
    for kind, begin in (("stuck", 0), ("none", 4), ("stuck", 6)):
        table.inject("left", kind)
        block.process(clean[begin:], faulty[begin:])
    assert faulty[:, 0].tolist() == [0, 0, 0, 0, 12, 15, 18, 18, 18, 18]


def test_the_table_is_shared_and_refuses_what_there_is_not() -> None:
    table = FaultTable(NAMES)
    table.inject("left", "hum")
    assert table.present() == {"left": "hum"}
    with pytest.raises(ValueError, match="sensor is 'middle', must be left or right or cable"):
        table.inject("middle", "hum")
    with pytest.raises(ValueError, match="kind is 'fire', must be none or stuck or nan"):
        table.inject("left", "fire")
    with pytest.raises(ValueError, match="one for each of 3 channels"):
        Faults(table, (1.0,))
    assert len(KINDS) == 13
