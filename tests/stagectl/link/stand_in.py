"""A stage of first order behind a simulated adapter, in a thread or (run as a program) in a process of its own."""

import signal
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from firmware_sim.can_node import CanNode, Mishap
from firmware_sim.slcan_adapter import SlcanAdapter
from firmware_sim.stage_processor import Loops, Settings, StageProcessor
from rigkit.stop import on_signals
from stagectl.link.config import Link
from stagectl.wire.messages import Drive, Fault

PATIENT = 10.0
"""s of silence where it is not what is tested: as long as a rig file allows."""
SILENT = 1.0
"""s of silence where it is; such a test is one of a deadline."""


class FirstOrderStage:
    """Position follows the reference with a time constant of 2 ms; extension is a fifth of it, 1 V a um.

    A sensor that is stuck is noticed when it has given the same number for 50 ms of moving references.
    """

    def __init__(self) -> None:
        self.position, self.parameters, self.cleared = np.zeros(3), dict[str, np.ndarray](), 0
        self._stuck_at: float | None = None
        self._stuck_for = 0
        self.excited: int | None = None
        self._scale = 1.0

    def tick(self, reference: np.ndarray) -> dict[str, Any]:
        position, reference = np.empty_like(reference), reference * self._scale
        for n in range(len(reference)):
            self.position = position[n] = self.position + 0.05 * (reference[n] - self.position)
        if self._stuck_at is not None:
            moving = np.ptp(reference[:, 1]) > 0
            self._stuck_for = self._stuck_for + 1 if moving else self._stuck_for
            position[:, 1] = self._stuck_at
        fault = Fault.SENSOR_STUCK if self._stuck_for > 50 else Fault.NONE
        return {"position": position, "extension": position / 5, "voltage": reference * 1e6, "fault": fault}

    def excite(self, drive: Drive, axis: int) -> None:
        """Let volts be um; there is no loop to open."""
        self.excited, self._scale = axis, 1e-6 if drive is Drive.VOLTAGE else 1.0

    def release(self) -> None:
        self.excited, self._scale = None, 1.0

    def suffer(self, _: str) -> None:
        self._stuck_at = float(self.position[1])

    def commit(self, parameters: Mapping[str, np.ndarray]) -> None:
        if "refused" in parameters:
            raise ValueError("refused is no parameter")
        self.parameters = dict(parameters)

    def clear(self) -> None:
        self._stuck_at, self._stuck_for, self.cleared = None, 0, self.cleared + 1


def node(path: Path, settings: Settings, mishaps: tuple[Mishap, ...] = ()) -> tuple[CanNode, FirstOrderStage]:
    """Return a stand-in that bears standing still itself for as long as it bears the host's silence."""
    stage, settings = FirstOrderStage(), replace(settings, behind=max(settings.behind, settings.silence))
    processor = StageProcessor(
        Loops(stage.tick, stage.commit, stage.clear, stage.excite, stage.release), settings, monotonic()
    )
    return CanNode(SlcanAdapter(path), processor, stage.suffer, mishaps), stage


@contextmanager
def running(path: Path, settings: Settings) -> Iterator[tuple[CanNode, FirstOrderStage]]:
    """Run a stand-in in a thread."""
    made, stage = node(path, settings)
    stop = threading.Event()
    thread = threading.Thread(target=made.run, args=(stop,))
    thread.start()
    try:
        yield made, stage
    finally:
        stop.set()
        thread.join()


def link_to(path: Path, **others: Any) -> Link:
    return Link(**{"channel": str(path), "silence": PATIENT, "patience": 10.0} | others)


if __name__ == "__main__":
    over = threading.Event()
    alone, _ = node(Path(sys.argv[1]), Settings(silence=PATIENT))
    with on_signals({signal.SIGTERM: over.set}):
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        alone.run(over)
    sys.stdout.write(f"{alone.adapter.dropped} {alone.adapter.refused}\n")
