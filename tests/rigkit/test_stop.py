"""Ctrl-C that ends a long job safely."""

import os
import signal
import subprocess
import sys

import pytest

from rigkit.stop import SIGNALS, on_signals, stoppable
from tests.until import EVER

THREE_TIMES = """
import os, signal, threading
from rigkit.stop import stoppable
with stoppable():
    os.kill(os.getpid(), signal.SIGINT)
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        os.kill(os.getpid(), signal.SIGTERM)
"""


@pytest.mark.parametrize("number", SIGNALS)
def test_the_first_signal_asks_and_the_block_goes_on(number: int, capfd: pytest.CaptureFixture[str]) -> None:
    with stoppable() as request:
        assert not request.made
        os.kill(os.getpid(), number)
        assert request.made
    assert "stopping safely; Ctrl-C again ends at once" in capfd.readouterr().err


def test_the_second_signal_interrupts() -> None:
    def stopped_twice() -> None:
        with stoppable():
            os.kill(os.getpid(), signal.SIGINT)
            os.kill(os.getpid(), signal.SIGTERM)

    with pytest.raises(KeyboardInterrupt):
        stopped_twice()


def test_the_third_is_the_systems() -> None:
    done = subprocess.run([sys.executable, "-c", THREE_TIMES], capture_output=True, timeout=EVER, check=False)
    assert done.returncode == -signal.SIGTERM


def test_afterwards_signals_do_what_they_did_before() -> None:
    before = [signal.getsignal(number) for number in SIGNALS]
    with stoppable():
        assert [signal.getsignal(number) for number in SIGNALS] != before
    assert [signal.getsignal(number) for number in SIGNALS] == before


HELD = """
import os, signal, threading
from rigkit.stop import on_signals
event = threading.Event()
with on_signals({signal.SIGTERM: event.set}):
    with event._cond:  # as in its `wait`, for some instructions
        os.kill(os.getpid(), signal.SIGTERM)
    print(event.wait(10))
"""


def test_a_signal_may_set_the_event_that_is_being_waited_for() -> None:
    """Interrupted with the event's lock in its hands, a handler that sets it would wait for itself."""
    done = subprocess.run([sys.executable, "-c", HELD], capture_output=True, text=True, timeout=EVER, check=False)
    assert done.stdout == "True\n"


def test_after_the_block_signals_do_what_they_did_before() -> None:
    before = signal.getsignal(signal.SIGUSR1)
    with on_signals({signal.SIGUSR1: lambda: None}):
        assert signal.getsignal(signal.SIGUSR1) != before
    assert signal.getsignal(signal.SIGUSR1) == before


@pytest.mark.parametrize("program", ["vibractl", "stagectl", "calibration"])
def test_a_program_that_is_interrupted_while_it_imports_ends_without_a_traceback(program: str) -> None:
    code = (
        "import sys\n"
        "class Interrupted:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name.startswith('rigkit'):\n"
        "            raise KeyboardInterrupt\n"
        f"from {program}.__main__ import main\n"
        "sys.meta_path.insert(0, Interrupted())\n"
        "sys.exit(main())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=EVER, check=False)
    assert (done.returncode, done.stderr) == (130, "")
