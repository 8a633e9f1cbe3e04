"""The force sensor's network box: it streams records over UDP to whoever asked last, as ATI's Net F/T does."""

import contextlib
import socket

import numpy as np

from firmware_sim.plants.force_sensor import ForceSensorPlant
from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.force_sensor import Record, Request, pack_record, unpack_request

MISHAPS = ("force-silent", "force-speak", "force-saturate", "force-recover", "force-drift")
"""What can be made to happen: it sends nothing and does again; its gages go to their end and come back; its zero moves
by 20 N."""
_LARGEST = 1_024
_BIGGEST_BURST = 8
"""Records that are caught up with after a pause; older ones are lost."""


class ForceBox:
    """Measures the wrench on the tool and answers requests; never waits.

    Modelled: streaming with and without end, software bias, both counters, status.  Not modelled: its web page and its
    other modes (buffered, multi-unit), thresholds.

    Parameters
    ----------
    sensor : ForceSensorPlant, of as many samples/s as records are sent
    host : str
    port : int, 0 for any that is free
    counts : array, shape (6,), counts a N and a N m

    Raises
    ------
    ValueError : the port cannot be had.
    """

    def __init__(self, sensor: ForceSensorPlant, host: str, port: int, counts: np.ndarray) -> None:
        self.sensor, self.is_silent, self.bias = sensor, False, np.zeros(6)
        self._counts = counts
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except OSError as fault:
            self._socket.close()
            raise ValueError(f"force_sensor.host {host}, force_sensor.port {port} cannot be had: {fault}") from None
        self._socket.setblocking(False)
        self.address: tuple[str, int] = self._socket.getsockname()
        self._listener: tuple[str, int] | None = None
        self._left, self._sent, self._begun = 0, 0, 0
        self._room = np.zeros((1, 6)), np.zeros((1, 1)), np.zeros((1, 1))

    @property
    def due(self) -> float:
        """When the next record is due, s after the start."""
        return self._begun / self.sensor.rate

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def serve(self, elapsed: float, wrench: np.ndarray) -> None:
        """Take requests, and send what is due `elapsed` s after the start; `wrench` (1, 6), N and N m, is felt."""
        with contextlib.suppress(BlockingIOError, ConnectionError):
            while True:
                self._take(*self._socket.recvfrom(_LARGEST))
        behind = int(elapsed * self.sensor.rate) + 1 - self._begun
        if behind > _BIGGEST_BURST:
            self._begun += behind - _BIGGEST_BURST
        while self.due <= elapsed:
            self._begun += 1
            self._measure(wrench)

    def suffer(self, name: str) -> None:
        """Let a mishap happen."""
        match name:
            case "force-silent" | "force-speak":
                self.is_silent = name == "force-silent"
            case "force-saturate":
                self.sensor.stuck = 0.0
            case "force-recover":
                self.sensor.stuck = np.inf
            case "force-drift":
                self.sensor.step_at = 0.0

    def _take(self, data: bytes, sender: tuple[str, int]) -> None:
        try:
            request, records = unpack_request(data)
        except GarbledError:
            return
        match request:
            case Request.STREAM:
                self._listener, self._left, self._sent = sender, records or -1, 0
            case Request.STOP:
                self._listener = None
            case Request.BIAS:
                self.bias = self._room[0][0].copy()

    def _measure(self, wrench: np.ndarray) -> None:
        measured, sample, status = self._room
        self.sensor.run(wrench, measured, sample, status)
        if self._listener is None or self._left == 0 or self.is_silent:
            return
        self._sent += 1
        self._left -= 1
        record = Record(self._sent, int(sample[0, 0]), int(status[0, 0]), measured[0] - self.bias)
        with contextlib.suppress(OSError, WireError):  # nobody listens, or the scale is too fine
            self._socket.sendto(pack_record(record, self._counts), self._listener)


BOXES = {"netft": ForceBox}
"""The box of each make, by its name in the cell's file (`force_sensor.wire`)."""
