"""The simulated cell on its real wires, as fast as all ends go: it makes a cycle when the last one was answered."""

import json
import select
import socket
from collections import deque
from collections.abc import Callable
from threading import Event, Thread
from time import monotonic
from typing import Any

import numpy as np

from firmware_sim.can_node import CanNode
from firmware_sim.robot_bench import Addresses, RobotBench
from firmware_sim.robot_cell import Blocks, cell_controller, cell_force_box
from firmware_sim.tracker import TrackerFaults
from stagectl.experiments.midranging.wired_blocks import LivePair
from stagectl.robot.config import CellConfig
from stagectl.robot.conversation import PortState
from stagectl.wire import messages
from stagectl.wire.robot import RATE
from tests.stagectl.link.stand_in import FirstOrderStage

BUSY = 10.0
"""s that anything may take on a busy machine."""
ANSWER = 0.5
"""s for which the bench waits for a program that has answered its last report; it must be less than `silence`."""
_SEEN = 1e-8
"""m to which the host hears a position."""
_LOOK = 2e-4
"""s from one look at what is beside the cell to the next."""
TRACKER_RATE = 125.0
"""samples/s: fewer than a tracker's, for a test's sake."""


class SteppedCell:
    """A bench in a thread, and the file that finds it; what is put into `mishaps` is called before the next cycle.

    No cycle begins before the last one is over for `beside`, or has waited for that as long as it may.

    Parameters
    ----------
    block : callable(CellConfig, int), optional
        Makes the blocks under the tool, for its changer; as `cell_controller` has it.
    settings : dict of tables of a cell's file
    """

    def __init__(self, block: Blocks | None = None, **settings: dict[str, Any]) -> None:
        port = _free_port()
        settings = settings | {"force_sensor": {"port": _free_port()} | settings.get("force_sensor", {})}
        given = CellConfig.model_validate_json(json.dumps(settings))
        faults = TrackerFaults(noise=2e-5, lost=0.01, unseen=0.01)
        force = cell_force_box(given)
        self.bench = RobotBench(
            cell_controller(given, block), Addresses(motion=port), TRACKER_RATE, faults, force=force
        )
        self._force = force
        commands, signals, tracker = (
            each.address[1] for each in (self.bench.program, self.bench.signals, self.bench.tracker)
        )
        times = {"silence": 250, "lag": BUSY, "patience": BUSY}
        found = {
            "robot": times | {"port": port, "commands": commands, "signals": signals},
            "tracker": {"port": tracker, "blind": BUSY, "lag": BUSY},
            "force_sensor": {"silence": BUSY},
        }
        whole = settings | {name: table | settings.get(name, {}) for name, table in found.items()}
        self.config = CellConfig.model_validate_json(json.dumps(whole))
        self.cycles = 0
        self.over = Event()
        self.mishaps: deque[Callable[[], None]] = deque()
        self.beside: Callable[[], bool] = lambda: True
        self._thread = Thread(target=self._run, daemon=True)

    def __enter__(self) -> "SteppedCell":
        """Begin."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self.over.set()
        self._thread.join(BUSY)
        ends = self.bench.program, self.bench.signals, self.bench.tracker, self.bench._socket, self._force  # noqa: SLF001
        for each in ends:
            each.close()

    def now(self) -> float:
        """Return the bench's time, s: a clock for the other ends, however slowly both go."""
        return self.cycles / RATE

    def _run(self) -> None:
        line = self.bench._socket  # noqa: SLF001 (its own run keeps real time)
        taken = 0
        while not self.over.is_set():
            self.cycles += 1
            self.bench.serve(self.now())
            while self.mishaps:
                self.mishaps.popleft()()
            self.bench.cycle(self.now())
            speaks = self.bench.controller.counts.taken > taken
            taken = self.bench.controller.counts.taken
            select.select([line], [], [], ANSWER if speaks else 1 / RATE)
            self._wait_beside()

    def _wait_beside(self) -> None:
        given_up = monotonic() + BUSY
        while not (self.beside() or self.over.is_set()) and monotonic() < given_up:
            self.over.wait(_LOOK)


class StageBeside:
    """Says that a cycle is over for the stage, too: the host has ticked, the stage has followed, the host has heard.

    Without it the machine decides which of the threads gets on, and what the host sees of the stage is as old as that.

    Parameters
    ----------
    node : CanNode, at the pace of the host
    stage : FirstOrderStage
    pair : callable() -> LivePair or None
        What the host has of it, while its wires are open.
    """

    def __init__(self, node: CanNode, stage: FirstOrderStage, pair: Callable[[], LivePair | None]) -> None:
        self._node, self._stage, self._pair, self._written = node, stage, pair, 0

    def __call__(self) -> bool:
        """Look."""
        pair = self._pair()
        if pair is None or pair.robot.state is not PortState.FOLLOWING or pair.robot.reason or pair.stage.reason:
            self._written = 0
            return True
        written = pair.stage.references.written
        if written == 0:  # its first tick is still to come
            return True
        if written == self._written or not self._has_followed(pair):
            return False
        self._written = written
        return True

    def _has_followed(self, pair: LivePair) -> bool:
        processor, (_, seen) = self._node.processor, pair.stage.signal("position")
        last = (pair.stage.sent - 1) % messages.REFERENCE.modulus
        has_all = len(pair.stage.references) == 0 and processor._stream.counter == last  # noqa: SLF001
        return has_all and np.allclose(seen, self._stage.position, rtol=0.0, atol=_SEEN)


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])
