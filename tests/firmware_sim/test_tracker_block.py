"""The simulated tracker as a block: its rate, its delay, its noise, and what goes wrong with it."""

import numpy as np

from firmware_sim.tracker_block import SEEN, TrackerView

RATE = 2_000.0


def look(tracker: TrackerView, seconds: float, speed: float = 0.0) -> dict[str, np.ndarray]:
    frames = round(seconds * RATE)
    tracker.prepare(RATE, frames)
    outputs = {port.name: np.empty((frames, port.width)) for port in tracker.outputs}
    workpiece = np.ones((frames, 3))
    workpiece[:, 1] += speed * np.arange(frames) / RATE
    tracker.process(np.zeros((frames, 3)), workpiece, np.tile([0.6, 0.8, 0.0, 0.0], (frames, 1)), *outputs.values())
    return outputs


def test_it_says_440_times_a_second_what_it_saw_4_ms_ago() -> None:
    seen = look(TrackerView(noise=0.0, warp=0.0, lost=0.0), 2.0, speed=0.01)
    assert seen["sample"][-1, 0] in (878, 879, 880)
    fresh = np.flatnonzero(np.diff(seen["sample"][:, 0])) + 1
    late = (fresh - 1) / RATE - (seen["workpiece_seen"][fresh, 1] - 1.0) / 0.01
    np.testing.assert_allclose(late, 0.0035, atol=0.0006)
    np.testing.assert_allclose(seen["stamp"][fresh, 0], (seen["workpiece_seen"][fresh, 1] - 1.0) / 0.01, atol=1e-9)


def test_the_noise_of_a_pose_is_that_of_its_leds_mean() -> None:
    seen = look(TrackerView(lost=0.0, unseen=0.0), 6.0)
    fresh = np.flatnonzero(np.diff(seen["sample"][:, 0])) + 1
    for name, leds in zip(("spindle", "workpiece_seen"), SEEN, strict=True):
        spread = seen[name][fresh, :3].std(axis=0)
        np.testing.assert_allclose(spread, 60e-6 / np.sqrt(leds), rtol=0.08)
    assert np.abs(np.linalg.norm(seen["workpiece_seen"][fresh, 3:], axis=1) - 1).max() < 1e-12


def test_its_volume_is_warped_and_stays_so() -> None:
    first, again = (look(TrackerView(noise=0.0), 4.0, speed=0.02)["workpiece_seen"] for _ in range(2))
    straight = look(TrackerView(noise=0.0, warp=0.0), 4.0, speed=0.02)["workpiece_seen"]
    np.testing.assert_array_equal(first, again)
    assert 1e-6 < np.abs((first - straight)[100:, :3]).max() < 200e-6


def test_lost_samples_are_missing_from_the_count_and_blind_ones_have_too_few_leds() -> None:
    seen = look(TrackerView(lost=0.3, unseen=0.0, blind=0.5, blind_for=0.2), 1.0)
    assert np.diff(seen["sample"][:, 0]).max() > 1
    blind = (seen["stamp"][:, 0] >= 0.5) & (seen["stamp"][:, 0] < 0.7)
    assert (seen["leds"][blind] == 2).all()
    np.testing.assert_array_equal(np.unique(seen["leds"][~blind][100:], axis=0), [SEEN])


def test_an_led_that_is_taken_for_another_makes_a_jump() -> None:
    seen = look(TrackerView(jump_at=0.5, jump=3e-3), 1.0)
    apart = seen["workpiece_seen"][-1, 0] - seen["workpiece_seen"][800, 0]
    assert abs(apart - 3e-3) < 0.5e-3
