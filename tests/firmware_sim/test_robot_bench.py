"""All four wires of the simulated cell at once, in real time, with the program's own ends on the other side."""

import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from threading import Event, Thread

import numpy as np
import pytest

from firmware_sim.plants.robot import RobotPlant
from firmware_sim.robot_bench import Addresses, RobotBench, robot_mishap
from firmware_sim.robot_cell import cell_controller
from firmware_sim.robot_controller import RobotController
from firmware_sim.wire_ends import EgmEnd
from stagectl.link.bus import LinkError
from stagectl.robot.config import CellConfig, Robot, Simulator, Tracker
from stagectl.robot.port import RobotPort
from stagectl.robot.program import RobotProgram, TorqueSignals
from stagectl.robot.tracker import TrackerLine
from tests.until import EVER, until

BUSY = 10.0
"""s that anything may take on a busy machine: as long as a rig file allows."""
BLIND = 1.0
"""s for which the tracker may be blind."""
pytestmark = pytest.mark.stall(0.5)


class Cell:
    """The bench in a thread, and the file that finds it."""

    def __init__(self, log: Path) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.bench = RobotBench(RobotController(RobotPlant(seed=2), end=EgmEnd()), Addresses(motion=port), log=log)
        robot = Robot(
            port=port,
            commands=self.bench.program.address[1],
            signals=self.bench.signals.address[1],
            silence=250,
            lag=BUSY,
            patience=BUSY,
        )
        tracker = Tracker(port=self.bench.tracker.address[1], blind=BLIND, lag=BUSY)
        self.config = CellConfig(robot=robot, tracker=tracker)
        self.stop, ready = Event(), Event()
        self._thread = Thread(target=self.bench.run, args=(ready.set, self.stop))
        self._thread.start()
        assert ready.wait(EVER)

    def end(self) -> None:
        self.stop.set()
        self._thread.join()


@pytest.fixture
def cell(tmp_path: Path) -> Iterator[Cell]:
    made = Cell(tmp_path / "torque.csv")
    try:
        yield made
    finally:
        made.end()


def test_every_wire_speaks_and_the_program_does_as_it_is_told(cell: Cell, tmp_path: Path) -> None:
    config, plant = cell.config, cell.bench.controller.plant
    with ExitStack() as stack:
        port = stack.enter_context(RobotPort(config))
        tracker = stack.enter_context(TrackerLine(config.tracker, port.hold, patience=BUSY))
        program = stack.enter_context(RobotProgram(config.robot, "127.0.0.1"))
        signals = stack.enter_context(TorqueSignals(config.robot, "127.0.0.1", time.monotonic))
        assert port.wait(50, BUSY)
        assert signals.wait(50, BUSY)
        report = port.report
        assert report is not None
        np.testing.assert_allclose(report.joint_angle, plant.home, atol=1e-4)
        assert np.abs(tracker.inbox.pose[:3] - plant.frames[7, :, 3]).max() < 5e-4
        assert np.abs(signals.newest[7:]).max() > 10.0
        program.soften([0.5, 0, 0, 0, 0, 0])
        program.clamp(True)
        program.clamp(False)
        with pytest.raises(LinkError, match="the robot's program refuses 'SOFT 2 0 0 0 0 0': ERROR softness"):
            program.soften([2, 0, 0, 0, 0, 0])
    cell.end()
    assert len((tmp_path / "torque.csv").read_text().splitlines()) > 50


def test_a_blind_tracker_holds_the_robot_and_gives_its_reason(cell: Cell) -> None:
    with RobotPort(cell.config) as port, TrackerLine(cell.config.tracker, port.hold, patience=BUSY) as tracker:
        port.start()
        tracker.start()
        cell.bench.suffer("blind")
        keep_alive(port)
        assert "the tracker is blind for 1" in port.reason
        assert "2 LEDs of frame 7 are seen" in port.reason


def test_a_tracker_whose_line_is_cut_is_connected_to_again(cell: Cell) -> None:
    with TrackerLine(cell.config.tracker, print, patience=BUSY) as tracker:
        cell.bench.suffer("hang-up")
        until(lambda: tracker.counts.reconnected > 0)
        before = tracker.counts.received
        until(lambda: tracker.counts.received > before)


def test_supervision_that_trips_is_the_ports_fault(cell: Cell) -> None:
    with RobotPort(cell.config) as port:
        port.start()
        cell.bench.suffer("trip")
        keep_alive(port)
        assert port.reason == "the robot's motors are off"


def keep_alive(port: RobotPort) -> None:
    """Give references, as a graph does, until a fault latches."""
    home, reports = port.sent.copy(), port.counts.received
    while not port.reason:
        port.conversation.wanted.put(home, home)
        port.flush()
        reports += 1
        port.wait(reports, BUSY)


def test_mishaps_are_read_and_refused_by_name() -> None:
    assert robot_mishap("trip@1") == (1.0, "trip")
    for wrong in ("dance@1", "trip", "trip@-1", "trip@nan"):
        with pytest.raises(ValueError, match="must be NAME@SECONDS"):
            robot_mishap(wrong)


def test_the_cells_file_says_which_robot_it_is() -> None:
    made = cell_controller(CellConfig(robot=Robot(arm="kuka", tool=0.25), simulator=Simulator(options={"seed": 7})))
    assert (made.plant.arm, made.plant.tool, made.plant.seed) == ("kuka", 0.25, 7)
    with pytest.raises(ValueError, match=r"simulator.options: .*unexpected keyword argument 'wheels'"):
        cell_controller(CellConfig(simulator=Simulator(options={"wheels": 4})))
    with pytest.raises(ValueError, match="the plant runs at 500 samples/s, must be 250"):
        cell_controller(CellConfig(simulator=Simulator(options={"rate": 500.0})))
