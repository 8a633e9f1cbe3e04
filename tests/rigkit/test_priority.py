"""Real-time priority is asked for, and given back."""

import gc
import os
import sys
import threading

import pytest

from rigkit.priority import all_real_time, real_time, undisturbed


def test_the_threads_own_scheduling_is_as_before_afterwards() -> None:
    before = os.sched_getscheduler(0)
    with real_time():
        assert os.sched_getscheduler(0) in (before, os.SCHED_FIFO)
    assert os.sched_getscheduler(0) == before


def policies() -> set[int]:
    """Return the policies of all threads of this program, without the flag that they are not inherited."""
    return {os.sched_getscheduler(int(task)) & ~os.SCHED_RESET_ON_FORK for task in os.listdir("/proc/self/task")}


def test_all_threads_go_first_but_those_started_meanwhile() -> None:
    ended, started = threading.Event(), []
    there = threading.Thread(target=ended.wait)
    there.start()
    before = policies()
    with all_real_time():
        meanwhile = policies()
        new = threading.Thread(target=lambda: started.append(os.sched_getscheduler(0)))
        new.start()
        new.join()
    assert policies() == before
    ended.set()
    there.join()
    assert meanwhile in (before, {os.SCHED_FIFO})
    assert set(started) <= before


def test_a_thread_that_has_priority_keeps_its_own() -> None:
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(3))
    except PermissionError:
        pytest.skip("real-time priority is not granted here")
    try:
        with all_real_time(), real_time(), undisturbed():
            assert (os.sched_getscheduler(0), os.sched_getparam(0).sched_priority) == (os.SCHED_RR, 3)
    finally:
        os.sched_setscheduler(0, *before)


def test_where_it_is_not_granted_the_block_runs_as_it_would(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    ran = False
    with real_time():
        ran = True
    assert ran


def test_nothing_is_collected_while_undisturbed_and_all_is_as_before_afterwards() -> None:
    turn = sys.getswitchinterval()
    with undisturbed():
        assert not gc.isenabled()
        assert sys.getswitchinterval() < turn
    assert gc.isenabled()
    assert sys.getswitchinterval() == turn


@pytest.mark.parametrize("is_frozen", [False, True])
def test_what_was_left_out_of_the_search_for_garbage_still_is(is_frozen: bool) -> None:
    before = gc.get_freeze_count() > 0
    try:
        gc.unfreeze()
        if is_frozen:
            gc.freeze()
        with undisturbed():
            assert gc.get_freeze_count() > 0
        assert (gc.get_freeze_count() > 0) is is_frozen
    finally:
        if before:
            gc.freeze()


def test_nothing_is_searched_for_again_within_a_block_in_which_nothing_is() -> None:
    searched = list[str]()
    with undisturbed():
        gc.callbacks.append(lambda phase, _: searched.append(phase))
        try:
            with undisturbed():
                assert not gc.isenabled()
        finally:
            gc.callbacks.pop()
        assert not gc.isenabled()
    assert searched == []
    assert gc.isenabled()
