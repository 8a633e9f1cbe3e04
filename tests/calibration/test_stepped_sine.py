import numpy as np
import pytest

from calibration.stepped_sine import Tones
from vibractl.config import Limits
from vibractl.guard import violation

RATE = 44_100.0
FREQUENCY = np.array([100.0, 101.0, 101.5, 350.0])
PRELOAD = np.array([60.0, 60.5, 45.0, 80.0])


def tones(**changes: object) -> Tones:
    settings: dict[str, object] = {
        "frequency": FREQUENCY,
        "preload_frequency": PRELOAD,
        "settle": np.array([0.1, 0.2, 0.1, 0.3]),
        "tone": 0.5,
        "preload": 0.8,
        "probe": 0.1,
        "sides": 2,
        "rate": RATE,
        "step": 16,
    }
    return Tones(**(settings | changes))  # type: ignore[arg-type]


def test_in_each_window_one_side_carries_preload_and_probe_and_the_other_the_preload_alone() -> None:
    batch = tones()
    drive = batch.drive()
    time = np.arange(batch.window) / RATE
    for side, slot in np.ndindex(2, 4):
        tone = batch.order[side, slot]
        window = drive[batch.starts[side, slot] :][: batch.window]
        basis = np.exp(2j * np.pi * np.outer(time, [FREQUENCY[tone], PRELOAD[tone]]))
        parts = np.concatenate([basis.real, basis.imag], axis=1)
        found, *_ = np.linalg.lstsq(parts, window, rcond=None)
        amplitude = np.hypot(found[:2], found[2:])
        assert parts @ found == pytest.approx(window, abs=1e-9)
        assert amplitude[0] == pytest.approx([0.1 * (side == 0), 0.1 * (side == 1)], abs=1e-9)
        assert amplitude[1] == pytest.approx([0.8, 0.8])


def test_the_second_side_takes_the_tones_back_down() -> None:
    assert tones().order.tolist() == [[0, 1, 2, 3], [3, 2, 1, 0]]


def test_windows_begin_at_multiples_of_the_step_after_the_time_to_settle() -> None:
    batch = tones()
    assert np.all(batch.starts % 16 == 0)
    gaps = np.diff(batch.starts[0]) - batch.window
    assert gaps / RATE == pytest.approx([0.2, 0.1, 0.3], abs=3e-4)


def test_the_drive_goes_from_rest_to_rest_without_a_step() -> None:
    drive = tones().drive()
    fastest = 2 * np.pi * (0.8 * 80 + 0.1 * 350)
    assert np.abs(drive[[0, -1]]).max() < 1e-6
    assert np.abs(np.diff(drive, axis=0)).max() * RATE < 1.5 * fastest
    assert violation(drive, Limits(slew=2 * fastest), RATE) is None


@pytest.mark.parametrize("sides", [1, 3])
def test_any_number_of_sides_takes_its_turn(sides: int) -> None:
    batch = tones(sides=sides, preload=0.0)
    drive = batch.drive()
    for side in range(sides):
        middle = drive[batch.starts[side, 0] : batch.starts[side, 0] + batch.window]
        assert np.flatnonzero(np.abs(middle).max(axis=0) > 1e-9).tolist() == [side]


def test_no_time_to_settle_is_allowed() -> None:
    assert np.isfinite(tones(settle=np.zeros(4)).drive()).all()
