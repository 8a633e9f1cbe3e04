"""Real-time priority is asked for, and given back."""

import os

import pytest

from stagectl.link.priority import real_time


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
