"""That a client leaves a JACK server which is gone, whatever libjack does about it."""

import gc
import threading
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from firmware_sim import jack_client
from firmware_sim.jack_client import JackClient, JackError
from tests.until import EVER

FRAMES = 16


class StandIn:
    """A client of a server that tells nothing of its end, and that libjack never gets away from."""

    samplerate, blocksize = 44_100, FRAMES

    def __init__(self) -> None:
        ports = SimpleNamespace(register=lambda _: SimpleNamespace(get_array=lambda: np.zeros(FRAMES, np.float32)))
        self.inports = self.outports = ports
        self.activate = self.deactivate = lambda: None
        self.process: Any = None
        self.shut_down: Any = None
        self.left, self.free = threading.Event(), threading.Event()

    def set_process_callback(self, callback: Any) -> None:
        self.process = callback

    def set_shutdown_callback(self, callback: Any) -> None:
        self.shut_down = callback

    def close(self) -> None:
        self.left.set()
        self.free.wait(EVER)


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> StandIn:
    server = StandIn()
    monkeypatch.setattr(jack_client, "_connect", lambda _: server)
    monkeypatch.setattr(jack_client, "SILENCE", 0.02)
    monkeypatch.setattr(jack_client, "LEAVING", 0.02)
    return server


def client() -> JackClient:
    wiring = SimpleNamespace(outputs=3, inputs=3)
    laboratory: Any = SimpleNamespace(wiring=wiring, prepare=lambda *_: None, step=lambda *_: None)
    return JackClient(laboratory, 44_100, "shaker")


def test_a_server_that_is_silent_is_gone(server: StandIn) -> None:
    with pytest.raises(JackError, match=r"the JACK server has ended: no period for 0\.02 s"):
        client().run(lambda: None)
    assert server.left.is_set()
    server.free.set()


def test_one_that_libjack_cannot_leave_is_left_all_the_same(server: StandIn) -> None:
    with pytest.raises(JackError, match="the JACK server has ended: killed"):
        client().run(lambda: server.shut_down(None, "killed"))
    assert not server.free.is_set()
    server.free.set()


def test_one_that_has_periods_is_served_until_the_end(server: StandIn, monkeypatch: pytest.MonkeyPatch) -> None:
    waits = 0

    class Beats(threading.Event):
        """While it is waited for, a period comes, a few times; then it is asked to end."""

        def wait(self, timeout: float | None = None) -> bool:
            nonlocal waits
            waits += 1
            server.process(FRAMES)
            return waits == 5

    monkeypatch.setattr(jack_client, "threading", SimpleNamespace(Event=Beats, Thread=threading.Thread))
    server.free.set()
    client().run(lambda: None)
    assert waits == 5
    assert gc.isenabled()  # as it was before
