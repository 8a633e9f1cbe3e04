"""What is quick comes from the stage's sensors at once, what is slow from the tracker; offsets are touched off."""

import numpy as np

from stagectl.experiments.toroid.relative_position import RelativePosition

RATE, LATE = 2_000.0, 8


def run(parts: dict[str, np.ndarray], by_laser: tuple[bool, bool, bool] = (False, False, False)) -> np.ndarray:
    frames = len(next(iter(parts.values())))
    block = RelativePosition((1.0, 1.0, 1.0), by_laser, LATE / RATE, 0.2, 0.5)
    block.prepare(RATE, frames)
    deviation = np.empty((frames, 3))
    given = [parts.get(port.name, np.zeros((frames, 3))) for port in block.inputs]
    block.process(*given, deviation)
    return deviation


def step(at: float, size: float, frames: int = 8_000, late: int = 0) -> np.ndarray:
    signal = np.zeros((frames, 3))
    signal[round(at * RATE) + late :] = size
    return signal


def test_offsets_of_standing_still_are_taken_off() -> None:
    deviation = run({"spindle": np.full((4_000, 3), 0.3), "workpiece": np.full((4_000, 3), 1.7)})
    assert np.abs(deviation).max() < 1e-12


def test_the_plate_is_seen_at_once_and_not_twice() -> None:
    """The tracker sees it, too, later."""
    moved = {"position": step(1.0, 1e-4), "spindle": step(1.0, 1e-4, late=LATE)}
    deviation = run(moved)
    at = round(1.0 * RATE)
    np.testing.assert_allclose(deviation[at - 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(deviation[at:], 1e-4, rtol=1e-6)


def test_the_robot_is_seen_as_slowly_as_the_low_passes_are() -> None:
    deviation = run({"workpiece": step(1.0, -1e-4)})[:, 0]
    at = round(1.0 * RATE)
    after = np.array([1, round(RATE / (2 * np.pi)), 6_000 - 1])
    np.testing.assert_allclose(
        deviation[at + after - 1], 1e-4 * (1 - np.exp([-0.003, -1, -19]) * [1.003, 2, 20]), rtol=0.01, atol=1e-9
    )


def test_a_laser_sees_the_robot_at_once() -> None:
    seen = {"workpiece": step(1.0, -1e-4, late=LATE), "absolute": 5e-3 + step(1.0, 1e-4)}
    deviation = run(seen, (True, False, False))
    np.testing.assert_allclose(deviation[round(1.0 * RATE) :, 0], 1e-4, rtol=1e-6)
    assert abs(deviation[round(1.0 * RATE) + LATE, 1]) < 1e-8


def test_the_path_is_no_deviation() -> None:
    path = np.column_stack([np.linspace(0, 1e-3, 4_000)] * 3)
    assert np.abs(run({"spindle": path, "wanted": path})).max() < 1e-12
