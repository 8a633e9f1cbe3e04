"""The ring between two threads."""

import threading

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rigkit.ring import Ring


@given(st.lists(st.tuples(st.booleans(), st.integers(0, 9)), max_size=60))
def test_what_is_taken_is_what_was_put_in_order(steps: list[tuple[bool, int]]) -> None:
    ring, number = Ring(2, 7), 0
    waiting: list[int] = []
    for is_put, count in steps:
        if is_put:
            ring.put(np.arange(number, number + count, dtype=float)[:, np.newaxis] * [1.0, -1.0])
            waiting += list(range(number, number + min(count, 7 - len(waiting))))
            number += count
        else:
            block = np.full((count, 2), np.nan)
            taken = ring.take(block)
            assert block[:taken].tolist() == [[value, -value] for value in waiting[:taken]]
            assert np.isnan(block[taken:]).all()
            assert taken == min(count, len(waiting))
            del waiting[:taken]
        assert len(ring) == len(waiting)
    assert ring.offered == number


def test_skipped_samples_are_gone() -> None:
    ring = Ring(1, 4)
    ring.put(np.ones((3, 1)))
    ring.skip()
    assert (len(ring), ring.offered, ring.refused) == (0, 3, 0)


def test_two_threads_lose_nothing() -> None:
    ring, total = Ring(1, 1000), 20_000
    got = np.zeros((total, 1))

    def write() -> None:
        done = 0
        while done < total:
            room = min(1000 - len(ring), 37, total - done)
            ring.put(np.arange(done, done + room, dtype=float)[:, np.newaxis])
            done += room

    writer = threading.Thread(target=write)
    writer.start()
    done = 0
    while done < total:
        done += ring.take(got[done : done + 50])
    writer.join()
    np.testing.assert_array_equal(got[:, 0], np.arange(total))
