"""Waiting: what a wait that fails says of what it waited for."""

import threading
from types import SimpleNamespace

import pytest

from tests.until import until


def test_it_returns_as_soon_as_the_condition_is_true() -> None:
    there = threading.Event()
    threading.Timer(0.01, there.set).start()
    until(there.is_set)


def test_a_wait_that_fails_says_for_what_it_waited_and_what_was_there() -> None:
    lab, volts = SimpleNamespace(state="RUNNING", done=lambda: 3), [2.5]
    with pytest.raises(AssertionError) as fault:
        until(lambda: lab.state == "FAULT" and abs(volts[0] - 3) < 0.1 and lab.done() > 4, 0.0)
    assert str(fault.value).splitlines() == [
        "within 0 s it has not come to pass that",
        "  lab.state == 'FAULT' and abs(volts[0] - 3) < 0.1 and (lab.done() > 4)",
        "  lab.state was 'RUNNING'",
        "  volts[0] was 2.5",
        "  lab.done() was 3",
    ]


def test_what_cannot_be_looked_at_is_said_to_be_so() -> None:
    lab = SimpleNamespace()
    with pytest.raises(AssertionError, match=r"lab.state was not to be had: AttributeError"):
        until(lambda: hasattr(lab, "state") and lab.state, 0.0)
    with pytest.raises(AssertionError, match="Event.is_set"):
        until(threading.Event().is_set, 0.0)
