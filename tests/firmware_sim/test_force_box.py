"""The force sensor's box over UDP in real time, with the program's own end on the other side."""

import re
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread

import numpy as np
import pytest

from firmware_sim.force_box import ForceBox
from firmware_sim.plants.force_sensor import ForceSensorPlant
from firmware_sim.robot_cell import cell_force_box
from stagectl.link.bus import LinkError
from stagectl.robot.config import CellConfig
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.force_inbox import ForceInbox
from stagectl.robot.force_stream import ForceStream
from stagectl.wire.force_sensor import Request, pack_request, unpack_records
from tests.until import until

BUSY = 10.0
"""s that anything may take on a busy machine."""
pytestmark = pytest.mark.stall(0.05)


class Served:
    """A box in a thread, a wrench that can be set, and the table that finds it."""

    def __init__(self) -> None:
        plant = ForceSensorPlant(500.0, noise=0.1, drift=0.0, crosstalk=0.0)
        self.box = ForceBox(plant, "127.0.0.1", 0, ForceSensor().counts)
        self.config = ForceSensor(port=self.box.address[1], silence=1.0, saturated=0.05, rest=0.2)
        self.wrench, self.over = np.zeros((1, 6)), Event()
        self._thread = Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        start = time.monotonic()
        while not self.over.wait(0.001):
            self.box.serve(time.monotonic() - start, self.wrench)

    def end(self) -> None:
        self.over.set()
        self._thread.join()
        self.box.close()


@pytest.fixture
def served() -> Iterator[Served]:
    made = Served()
    try:
        yield made
    finally:
        made.end()


@contextmanager
def heard(config: ForceSensor, reasons: list[str]) -> Iterator[ForceInbox]:
    """Follow what comes over the wire, and take zero force."""
    inbox = ForceInbox(config, reasons.append)
    with ForceStream(config, inbox, time.monotonic, BUSY):
        inbox.rest(time.monotonic())
        until(lambda: inbox.is_tared)
        yield inbox


def test_zero_force_is_taken_at_rest_a_push_is_seen_and_is_a_drift_at_the_next_rest(served: Served) -> None:
    reasons: list[str] = []
    with heard(served.config.model_copy(update={"host": "localhost"}), reasons) as inbox:
        served.wrench[0] = 0.0, 25.0, 0.0, 0.0, 0.0, 1.0
        until(lambda: bool(abs(inbox.wrench[1] - 25.0) < 1.0 and abs(inbox.wrench[5] - 1.0) < 0.1 and inbox.is_good))
        assert inbox.counts.garbled == 0
        assert not reasons
        inbox.rest(time.monotonic())
        until(lambda: bool(reasons))
        assert re.match("the force sensor has drifted: at rest by .*, 25", reasons[0])


@pytest.mark.parametrize(("mishap", "name"), [("force-silent", "silent"), ("force-saturate", "saturated")])
def test_faults_are_told_by_name(served: Served, mishap: str, name: str) -> None:
    reasons: list[str] = []
    with heard(served.config, reasons) as inbox:
        inbox.begin(time.monotonic())
        served.box.suffer(mishap)
        until(lambda: bool(reasons))
        assert inbox.fault == name
        assert reasons[0].startswith(f"the force sensor is {name}")


def test_a_drift_of_the_box_is_told_at_the_next_rest(served: Served) -> None:
    reasons: list[str] = []
    with heard(served.config, reasons) as inbox:
        served.box.suffer("force-drift")
        inbox.rest(time.monotonic())
        until(lambda: inbox.fault == "drifted")


def test_a_box_that_is_not_there_is_told_of() -> None:
    def enter(config: ForceSensor) -> None:
        with ForceStream(config, ForceInbox(config, print), time.monotonic, 0.2):
            pass

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        with pytest.raises(LinkError, match="sends nothing within 0.2 s"):
            enter(ForceSensor(port=free.getsockname()[1]))
    with pytest.raises(LinkError, match="force_sensor.host no.such.host.invalid is not known"):
        enter(ForceSensor(host="no.such.host.invalid"))


def test_it_sends_as_many_as_are_wanted_stops_and_takes_bias() -> None:
    box = ForceBox(ForceSensorPlant(500.0, noise=0.0, moment_noise=0.0), "127.0.0.1", 0, ForceSensor().counts)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as host:
        host.bind(("127.0.0.1", 0))
        host.settimeout(BUSY)
        nothing, elapsed = np.zeros((1, 6)), 0.0

        def ask(request: Request, records: int, seconds: float) -> None:
            nonlocal elapsed
            host.sendto(pack_request(request, records), box.address)
            for _ in range(round(seconds * 500)):
                elapsed += 0.002
                box.serve(elapsed, nothing)

        ask(Request.STREAM, 3, 0.1)
        got = [unpack_records(host.recv(1_024), ForceSensor().counts)[0] for _ in range(3)]
        assert [each.counter for each in got] == [1, 2, 3]
        assert np.abs(got[-1].wrench).max() > 0.1
        ask(Request.BIAS, 0, 0.002)
        ask(Request.STREAM, 1, 0.1)
        assert np.abs(unpack_records(host.recv(1_024), ForceSensor().counts)[0].wrench).max() < 0.01
        ask(Request.STREAM, 0, 0.0)
        ask(Request.STOP, 0, 0.1)
        host.settimeout(0.05)
        with pytest.raises(TimeoutError):
            host.recv(1_024)
    box.close()


def test_a_make_without_a_box_is_refused_by_name() -> None:
    sensor = ForceSensor().model_copy(update={"wire": "spoken"})
    with pytest.raises(ValueError, match="force_sensor.wire is 'spoken', must be netft in the simulator"):
        cell_force_box(CellConfig().model_copy(update={"force_sensor": sensor}))


def test_a_cells_file_says_which_sensor() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        cell = CellConfig(force_sensor=ForceSensor(port=taken.getsockname()[1]))
        with pytest.raises(ValueError, match="force_sensor.port .* cannot be had"):
            cell_force_box(cell)
    for options, reason in (({"springs": 3}, ": .*springs"), ({"bias": -3.0}, ".bias is -3.0, must be 0 to 1000 N")):
        plants = cell.plants.model_copy(update={"force_sensor_options": options})
        with pytest.raises(ValueError, match=f"plants.force_sensor_options{reason}"):
            cell_force_box(cell.model_copy(update={"plants": plants}))
