"""References wait for their millisecond, in order and without gaps."""

import numpy as np
import pytest

from firmware_sim.reference_queue import ReferenceQueue


def block(start: float) -> np.ndarray:
    return np.tile(start + np.arange(10.0)[:, np.newaxis], (1, 3))


def test_blocks_are_played_in_order_once_enough_wait() -> None:
    queue = ReferenceQueue(2)
    queue.put(0, block(10.0))
    assert not queue.take().any()
    queue.put(0, block(20.0))
    np.testing.assert_array_equal(queue.take(), block(10.0))
    np.testing.assert_array_equal(queue.take(), block(20.0))
    assert queue.underruns == 0


def test_when_none_waits_the_last_sample_is_held_and_counted_once() -> None:
    queue = ReferenceQueue(1)
    queue.put(0, block(10.0))
    queue.take()
    assert (queue.take() == 19.0).all()
    assert (queue.take() == 19.0).all()
    assert queue.underruns == 1
    queue.put(0, block(20.0))
    np.testing.assert_array_equal(queue.take(), block(20.0))


def test_lost_blocks_are_filled_by_a_straight_line() -> None:
    queue = ReferenceQueue(1)
    queue.put(0, block(0.0))
    queue.put(2, block(29.0))
    queue.take()
    filled = np.vstack([queue.take(), queue.take()])
    np.testing.assert_allclose(np.diff(np.vstack([block(0.0)[-1:], filled]), axis=0), 1.0)
    np.testing.assert_array_equal(queue.take(), block(29.0))
    assert queue.lost == 2


def test_a_block_of_one_sample_is_reached_along_a_straight_line() -> None:
    queue = ReferenceQueue(1)
    queue.put(0, np.full((1, 3), 10.0))
    np.testing.assert_allclose(queue.take()[:, 0], np.arange(1.0, 11.0))
    queue.put(1, np.full((1, 3), 30.0))
    np.testing.assert_allclose(np.vstack([queue.take(), queue.take()])[:, 2], np.arange(11.0, 31.0))


def test_it_goes_back_to_mid_travel_along_a_raised_cosine() -> None:
    queue = ReferenceQueue(1)
    queue.put(0, block(0.0))
    queue.take()
    queue.put(0, block(100.0))
    queue.retreat(0.1)
    way = np.vstack([queue.take() for _ in range(len(queue))])
    assert len(way) == 1000
    assert way[-1] == pytest.approx(0.0, abs=1e-12)
    assert np.abs(np.diff(way, axis=0)).max() < 9.0 * np.pi / 2 / 1000 * 1.01
    assert not queue.take().any()


def test_what_is_too_much_is_lost_from_the_oldest_on() -> None:
    queue = ReferenceQueue(1)
    for n in range(ReferenceQueue.LONGEST + 3):
        queue.put(0, block(100.0 * n))
    assert queue.lost == 3
    np.testing.assert_array_equal(queue.take(), block(300.0))


def test_cleared_it_starts_from_mid_travel() -> None:
    queue = ReferenceQueue(1)
    queue.put(0, block(10.0))
    queue.take()
    queue.clear(1)
    assert not queue.take().any()
    assert (len(queue), queue.underruns) == (0, 0)
