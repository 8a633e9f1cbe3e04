"""Signals ask a running procedure to pause, to go on and to stop."""

import os
import signal

from calibration.joint_clamping.requests import requests


def test_signals_ask_to_pause_to_go_on_and_to_stop() -> None:
    before = signal.getsignal(signal.SIGUSR1)
    with requests() as asked:
        assert not asked.pause
        assert not asked.stop
        os.kill(os.getpid(), signal.SIGUSR1)
        assert asked.pause
        os.kill(os.getpid(), signal.SIGUSR2)
        assert not asked.pause
        os.kill(os.getpid(), signal.SIGTERM)
        assert asked.stop
    assert signal.getsignal(signal.SIGUSR1) is before
