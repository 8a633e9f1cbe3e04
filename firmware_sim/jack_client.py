"""The simulated laboratory as a client of a JACK audio server, where any program can play to it and record from it."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from firmware_sim.laboratory import Laboratory
from rigkit.priority import uncollected

SILENCE = 30.0
"""s without a period, after which a server is taken to be gone: libjack does not always tell."""
LEAVING = 5.0
"""s that libjack may take to leave a server; it can wait for ever for one that is gone."""


class JackError(OSError):
    """The JACK server, or the library that talks to it, is not there or not as wanted."""


class JackClient:
    """A client whose inputs are the card's outputs and whose outputs are the card's inputs, in the order of channels.

    PortAudio lists it as a device under its name.

    Parameters
    ----------
    laboratory : Laboratory
    rate : float, samples/s
        The server must run at it.
    name : str

    Raises
    ------
    JackError : libjack or its Python module is missing, no server runs, it has another rate, or the name is taken.
    """

    def __init__(self, laboratory: Laboratory, rate: float, name: str) -> None:
        self._laboratory = laboratory
        self._ended = threading.Event()
        self.fault, self._periods = "", 0
        self._client = _connect(name)
        if self._client.samplerate != rate:
            served = self._client.samplerate
            self._client.close()
            raise JackError(f"the JACK server runs at {served:g} samples/s, must be audio.rate, {rate:g}")
        wiring, frames = laboratory.wiring, self._client.blocksize
        self._played = np.zeros((frames, wiring.outputs), np.float32)
        self._recorded = np.zeros((frames, wiring.inputs), np.float32)
        self._ins = [self._client.inports.register(f"in_{n + 1}") for n in range(wiring.outputs)]
        self._outs = [self._client.outports.register(f"out_{n + 1}") for n in range(wiring.inputs)]
        laboratory.prepare(rate, frames)
        self._client.set_process_callback(self._process)
        self._client.set_shutdown_callback(self._shut_down)

    def run(self, ready: Callable[[], None]) -> None:
        """Serve until `end` is called or the server is gone; then leave.

        Parameters
        ----------
        ready : callable()
            Called once, when others can connect.

        Raises
        ------
        JackError : the server is gone, or the plant has failed.
        """
        with uncollected():
            self._client.activate()
            ready()
            served = -1
            while not self._ended.wait(SILENCE):
                if served == self._periods:
                    self._fail(f"the JACK server has ended: no period for {SILENCE:g} s")
                served = self._periods
        leaving = threading.Thread(target=self._leave, daemon=True)
        leaving.start()
        leaving.join(LEAVING)
        if self.fault:
            raise JackError(self.fault)

    def end(self) -> None:
        """Let `run` return; safe in a signal handler."""
        self._ended.set()

    def _leave(self) -> None:
        if not self.fault:
            self._client.deactivate()
        self._client.close()

    def _process(self, frames: int) -> None:
        self._periods += 1
        try:
            if frames != len(self._played):
                raise ValueError(f"the period is {frames} samples, must stay {len(self._played)}")
            for channel, port in enumerate(self._ins):
                self._played[:, channel] = port.get_array()
            self._laboratory.step(self._played, self._recorded)
            for channel, port in enumerate(self._outs):
                port.get_array()[:] = self._recorded[:, channel]
        except Exception as fault:
            for port in self._outs:
                port.get_array().fill(0.0)
            self._fail(f"the plant has failed: {type(fault).__name__}: {fault}")

    def _shut_down(self, status: object, reason: str) -> None:
        self._fail(f"the JACK server has ended: {reason}")

    def _fail(self, text: str) -> None:
        self.fault = self.fault or text
        self._ended.set()


def _connect(name: str) -> Any:
    try:
        import jack
    except ImportError as fault:
        raise JackError(f"{fault}; pip install 'vibrostage[jack]'") from fault
    except OSError as fault:
        raise JackError(f"{fault}; on Debian: apt-get install jackd2") from fault
    try:
        jack.set_error_function(lambda _: None)
        jack.set_info_function(lambda _: None)
        return jack.Client(name, no_start_server=True, use_exact_name=True)
    except jack.JackOpenError as fault:
        raise JackError(
            f"cannot join the JACK server as {name!r}: {fault}; start it first, for example "
            "jackd -d dummy -r 44100 -p 512, and see that JACK_DEFAULT_SERVER names it"
        ) from fault
