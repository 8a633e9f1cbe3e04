"""Faults on purpose: what sensors and links do when they fail, put between the device and the graph."""

import ctypes
import multiprocessing
from collections.abc import Sequence
from typing import Any

import numpy as np

from ctlblocks.block import Block, Port
from rigkit import faults_kernel as kernel

KINDS = (
    "none",
    "stuck",
    "nan",
    "inf",
    "zero",
    "full-scale",
    "x10",
    "sign-flip",
    "swap",
    "delay",
    "drop",
    "clock",
    "hum",
)
"""By number in the kernel: all well; the value at the beginning; NaN; infinity; 0; full scale; ten times; the other
sign; the next channel's; 10 ms late; one sample in a hundred is that before; a clock 100 ppm slow; 50 Hz, 1 % of full
scale."""


class FaultTable:
    """Which channel has which fault, in memory that processes share; it holds from the next sample on.

    Parameters
    ----------
    names : sequence of str
        Of the channels.
    """

    def __init__(self, names: Sequence[str]) -> None:
        raw = multiprocessing.get_context("spawn").RawArray(ctypes.c_double, 2 * len(names))
        self.__setstate__((tuple(names), raw))

    def __getstate__(self) -> Any:
        """Hand over the memory itself."""
        return self.names, self._raw

    def __setstate__(self, state: Any) -> None:
        """Attach to the memory of another process."""
        self.names, self._raw = state
        self.values = np.frombuffer(self._raw, kernel.CHANNEL)

    def inject(self, name: str, kind: str) -> None:
        """Give the channel `name` a fault, or take it away by "none".

        Raises
        ------
        ValueError : there is no such channel or kind; nothing has changed.
        """
        if name not in self.names:
            raise ValueError(f"sensor is {name!r}, must be {' or '.join(self.names)}")
        if kind not in KINDS:
            raise ValueError(f"kind is {kind!r}, must be {' or '.join(KINDS)}")
        channel = self.names.index(name)
        self.values["partner"][channel] = (channel + 1) % len(self.names)
        self.values["kind"][channel] = KINDS.index(kind)

    def present(self) -> dict[str, str]:
        """Return the faults there are, by channel."""
        kinds = {name: KINDS[int(kind)] for name, kind in zip(self.names, self.values["kind"], strict=True)}
        return {name: kind for name, kind in kinds.items() if kind != "none"}


class Faults(Block):
    """Pass the channels on, with the faults that a table says.

    Ports: `clean` in, `faulty` out, any unit.

    Parameters
    ----------
    table : FaultTable
    full_scale : sequence of float
        Of each channel, in its unit.
    unit : str
    """

    def __init__(self, table: FaultTable, full_scale: Sequence[float], unit: str = "1") -> None:
        width = len(table.names)
        if len(full_scale) != width:
            raise ValueError(f"full_scale has {len(full_scale)} values, must be one for each of {width} channels")
        self.inputs, self.outputs = (Port("clean", unit, width),), (Port("faulty", unit, width),)
        self.table, self.full_scale = table, np.array(full_scale, dtype=float)
        self._states, self._ring, self._clock = (
            np.zeros(width, kernel.STATE),
            np.zeros((2, width)),
            np.zeros(1, kernel.PROGRESS),
        )
        self._states["full"] = self.full_scale

    def prepare(self, rate: float, frames: int) -> None:
        """Forget what came before, and make room for the longest delay: a second's."""
        self._clock[0] = 0, 0, rate
        self._ring = np.zeros((max(2, round(rate)), len(self.table.names)))
        for name in ("running", "held", "lag"):
            self._states[name] = 0

    def process(self, clean: np.ndarray, faulty: np.ndarray) -> None:
        """Spoil one frame."""
        kernel.run(clean, faulty, self.table.values, self._states, self._ring, self._clock)
