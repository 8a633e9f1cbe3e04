"""The simulated robot cell on its wires: guided motion and force over UDP; program, torques and tracker over TCP."""

import contextlib
import gc
import math
import select
import socket
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Event

import numpy as np

from firmware_sim.force_box import MISHAPS as FORCE_MISHAPS
from firmware_sim.force_box import ForceBox
from firmware_sim.plants.robot_run_kernel import write_pose
from firmware_sim.robot_controller import RobotController
from firmware_sim.tcp_server import TcpServer
from firmware_sim.tracker import TrackerCamera, TrackerFaults
from rigkit.priority import real_time
from stagectl.wire.robot import RATE

MISHAPS = ("mute", "speak", "trip", "start", "blind", "see", "hang-up", "led-jump", "slip", *FORCE_MISHAPS)
"""What can be made to happen: the robot silent and back, its supervision tripped, its program started again by a
person; the tracker blind and back, its line cut, an LED taken for another by 5 mm; the clamp opened by force; and what
`ForceBox` suffers."""
_BASE, _TOOL = 0, 7
_JUMP = np.array([5e-3, 0.0, 0.0])


def robot_mishap(text: str) -> tuple[float, str]:
    """Read "NAME@SECONDS" into seconds after the start, and name.

    Examples
    --------
    >>> robot_mishap("blind@2.5")
    (2.5, 'blind')
    """
    name, _, seconds = text.partition("@")
    try:
        at = float(seconds)
    except ValueError:
        at = math.nan
    if name not in MISHAPS or not 0 <= at < math.inf:
        raise ValueError(f"a mishap is {text!r}, must be NAME@SECONDS with one of {', '.join(MISHAPS)}, at >= 0 s")
    return at, name


@dataclass(frozen=True)
class Addresses:
    """Where the cell's ends are: the host's UDP address, and this cell's TCP ports (0 for any that is free).

    Parameters
    ----------
    host : str, where everything is
    motion, program, signals, tracker : int
    """

    host: str = "127.0.0.1"
    motion: int = 6510
    program: int = 0
    signals: int = 0
    tracker: int = 0


class RobotBench:
    """Serves all wires from one thread, each at its own time.

    Parameters
    ----------
    controller : RobotController
    addresses : Addresses
    tracker_rate : float, samples/s
    faults : TrackerFaults
    mishaps : sequence of (s after the start, one of `MISHAPS`)
    log : Path or None
        Gets the torque signals as a CSV file, as a signal logger writes them.
    force : ForceBox or None
        The force sensor's, closed with the others.
    now : callable() -> float, s, a monotonic clock
    plate : array, shape (3,), m, where the spindle is on its stage, live; None where it stands still
    """

    def __init__(
        self,
        controller: RobotController,
        addresses: Addresses,
        tracker_rate: float = 440.0,
        faults: TrackerFaults | None = None,
        mishaps: Sequence[tuple[float, str]] = (),
        log: Path | None = None,
        force: ForceBox | None = None,
        now: Callable[[], float] = time.monotonic,
        plate: np.ndarray | None = None,
    ) -> None:
        self.plate, self.controller = np.zeros(3) if plate is None else plate, controller
        self.camera = TrackerCamera(self.poses, faults)
        self._host = (addresses.host, addresses.motion)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((addresses.host, 0))
        self._socket.setblocking(False)
        self.program = TcpServer(addresses.host, addresses.program)
        self.signals = TcpServer(addresses.host, addresses.signals)
        self.tracker = TcpServer(addresses.host, addresses.tracker)
        self.force, self._now, self._log_path = force, now, log
        self._looks, self._look_period = 0, 1 / tracker_rate
        self._to_come = sorted(mishaps)

    def poses(self) -> dict[int, np.ndarray]:
        """Return what carries LEDs, by number: spindle 0, links 1 to 6, tool 7; poses, shape (7,), m and 1."""
        found = {}
        for number in (_BASE, 1, 2, 3, 4, 5, 6, _TOOL):
            found[number] = np.zeros(7)
            write_pose(self.controller.plant.frames[number], found[number])
        found[_BASE][:3] += self.plate
        return found

    def run(self, ready: Callable[[], None], stop: Event) -> None:
        """Serve until `stop` is set.

        Parameters
        ----------
        ready : callable()
            Called once everything can be connected to.
        stop : Event
        """
        self.controller.advance()  # compiles
        gc.collect()
        gc.freeze()
        with contextlib.ExitStack() as stack:
            for each in (self.program, self.signals, self.tracker, self._socket, self.force):
                if each is not None:
                    stack.callback(each.close)
            log = stack.enter_context(self._log_path.open("w")) if self._log_path else None
            stack.enter_context(real_time())
            start, cycles = self._now(), 0
            ready()
            while not stop.is_set():
                elapsed = self._now() - start
                self.serve(elapsed)
                if elapsed * RATE >= cycles:
                    cycles += 1
                    line = self.cycle(elapsed)
                    if log is not None:
                        log.write(line)
                due = min(cycles / RATE, self._looks * self._look_period, self.force.due if self.force else math.inf)
                wait = start + due - self._now()
                if wait > 0:
                    select.select([self._socket], [], [], wait)

    def serve(self, elapsed: float) -> None:
        """Take what has come from the host, answer the program; let tracker and force sensor see what is due."""
        with contextlib.suppress(BlockingIOError, ConnectionError):
            while True:
                self.controller.receive(self._socket.recv(65_536))
        for line, text in self.program.received():
            self.program.send(f"{self.controller.do(text)}\n".encode(), line)
        if elapsed >= self._looks * self._look_period:
            self._looks += 1
            self.tracker.received()
            self.tracker.send(self.camera.look(elapsed))
        if self.force is not None:
            self.force.serve(elapsed, self.controller.wrench)

    def cycle(self, elapsed: float) -> str:
        """Run one cycle of the controller, report to the host, and return the line of its signals."""
        while self._to_come and elapsed >= self._to_come[0][0]:
            self.suffer(self._to_come.pop(0)[1])
        report = self.controller.advance()
        if report is not None:
            with contextlib.suppress(OSError):  # nobody listens
                self._socket.sendto(report, self._host)
        line = f"{self.controller.signal()}\n"
        self.signals.received()
        self.signals.send(line.encode())
        return line

    def suffer(self, name: str) -> None:
        """Let a mishap happen."""
        match name:
            case "mute" | "speak":
                self.controller.is_mute = name == "mute"
            case "trip":
                self.controller.plant.trip(1)
            case "start":
                self.controller.do("RESET")
            case "blind" | "see":
                self.camera.is_blind = name == "blind"
            case "hang-up":
                self.tracker.hang_up()
            case "led-jump":
                self.camera.jump = {_TOOL: _JUMP}
            case "slip":
                self.controller.plant.release()
            case _ if self.force is not None:
                self.force.suffer(name)
