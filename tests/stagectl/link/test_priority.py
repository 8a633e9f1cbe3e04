"""Real-time priority is asked for, and given back."""

import gc
import os
import sys

import pytest

from stagectl.link.priority import real_time, undisturbed


def test_the_threads_own_scheduling_is_as_before_afterwards() -> None:
    before = os.sched_getscheduler(0)
    with real_time():
        assert os.sched_getscheduler(0) in (before, os.SCHED_FIFO)
    assert os.sched_getscheduler(0) == before


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
    assert (sys.getswitchinterval(), gc.get_freeze_count()) == (turn, 0)
