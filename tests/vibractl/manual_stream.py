"""A stream whose clock is the test."""

from collections.abc import Callable
from typing import Any

import numpy as np


class ManualStream:
    """Calls back when it is told to, and keeps what was played."""

    in_process = True

    last: "ManualStream"

    def __init__(self, samplerate: float, blocksize: int, channels: tuple[int, int], **rest: Any) -> None:
        self._callback: Callable[..., None] = rest["callback"]
        self.blocksize, self._channels, self.active = blocksize, channels, True
        ManualStream.last = self

    def start(self) -> None:
        self.active = True

    def stop(self) -> None:
        self.active = False

    def abort(self) -> None:
        self.active = False

    def close(self) -> None:
        self.active = False

    def exchange(self) -> np.ndarray:
        """Run one block with silent inputs; return what was played, (samples, outputs), full scale."""
        heard = np.zeros((self.blocksize, self._channels[0]), np.float32)
        played = np.full((self.blocksize, self._channels[1]), np.nan, np.float32)
        self._callback(heard, played, self.blocksize, None, None)
        return played


class SharedStream(ManualStream):
    """One that other programs could open as well."""

    in_process = False
