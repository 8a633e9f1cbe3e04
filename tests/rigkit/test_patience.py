"""Patience counts what was waited for, not what a slow or sleeping machine took."""

import os
import subprocess
import sys

from rigkit.patience import LOOK, Patience, processor_time


class Clock:
    """Time that a test moves, s."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def looks_until_over(patience: Patience, clock: Clock, apart: float, progress: float = 0.0) -> int:
    for look in range(1_000):
        clock.now += apart
        if patience.is_over(progress):
            return look
    raise AssertionError("it is never over")


def test_it_is_over_when_nothing_has_moved_for_so_long() -> None:
    clock = Clock()
    assert looks_until_over(Patience(5.0, 1.0, clock), clock, 0.05) == 101


def test_a_look_after_this_program_stood_still_counts_little() -> None:
    clock = Clock()
    assert looks_until_over(Patience(5.0, 1.0, clock), clock, 60.0) == round(5.0 / LOOK) + 1


def test_progress_by_a_step_begins_it_anew_and_less_does_not() -> None:
    clock = Clock()
    patience = Patience(1.0, 0.1, clock)
    for look in range(200):
        clock.now += 0.05
        assert not patience.is_over(0.011 * look)  # a step in ten looks, half of the patience
    assert looks_until_over(patience, clock, 0.05, 0.011 * 199 + 0.05) <= 21


def test_the_processor_time_of_a_process_that_works_grows() -> None:
    code = "while True: pass"
    with subprocess.Popen([sys.executable, "-c", code]) as busy:
        try:
            while processor_time(busy.pid) < 0.05:
                assert busy.poll() is None
        finally:
            busy.kill()
    assert processor_time(os.getpid()) > 0
    assert processor_time(busy.pid) == 0.0  # it is gone
