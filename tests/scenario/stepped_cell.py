"""The simulated cell on its real wires, as fast as both ends go: it makes a cycle when the last one was answered."""

import json
import select
import socket
from collections import deque
from collections.abc import Callable
from threading import Event, Thread
from typing import Any

from firmware_sim.robot_bench import Addresses, RobotBench, cell_controller
from firmware_sim.tracker import TrackerFaults
from stagectl.robot.config import CellConfig
from stagectl.wire.egm import RATE

BUSY = 10.0
"""s that anything may take on a busy machine."""


TRACKER_RATE = 125.0
"""samples/s: fewer than a tracker's, for a test's sake."""


class SteppedCell:
    """A bench in a thread, and the file that finds it; what is put into `mishaps` is called before the next cycle.

    Parameters
    ----------
    settings : dict of tables of a cell's file
    """

    def __init__(self, **settings: dict[str, Any]) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        controller = cell_controller(CellConfig.model_validate_json(json.dumps(settings)))
        self.bench = RobotBench(
            controller, Addresses(motion=port), TRACKER_RATE, TrackerFaults(noise=2e-5, lost=0.01, unseen=0.01)
        )
        commands, signals, tracker = (
            each.address[1] for each in (self.bench.program, self.bench.signals, self.bench.tracker)
        )
        times = {"silence": 250, "lag": BUSY, "patience": BUSY}
        found = {
            "robot": times | {"port": port, "commands": commands, "signals": signals},
            "tracker": {"port": tracker, "blind": BUSY, "lag": BUSY},
        }
        self.config = CellConfig.model_validate_json(json.dumps(settings | found))
        self.over = Event()
        self.mishaps: deque[Callable[[], None]] = deque()
        self._thread = Thread(target=self._run, daemon=True)

    def __enter__(self) -> "SteppedCell":
        """Begin."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self.over.set()
        self._thread.join(BUSY)
        for each in (self.bench.program, self.bench.signals, self.bench.tracker, self.bench._socket):  # noqa: SLF001
            each.close()

    def _run(self) -> None:
        line = self.bench._socket  # noqa: SLF001 (its own run keeps real time)
        cycles, taken = 0, 0
        while not self.over.is_set():
            cycles += 1
            self.bench.serve(cycles / RATE)
            while self.mishaps:
                self.mishaps.popleft()()
            self.bench.cycle(cycles / RATE)
            speaks = self.bench.controller.counts.taken > taken
            taken = self.bench.controller.counts.taken
            select.select([line], [], [], 0.05 if speaks else 1 / RATE)
