"""The laser sensor through pyserial, on a pseudo-terminal: what it says, and what it does when it fails."""

import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_sim.serial_node import SerialNode
from stagectl.link.bus import LinkError
from stagectl.link.config import Laser
from stagectl.link.laser import Displacement, LaserLine
from tests.until import EVER


@contextmanager
def sensor(path: Path, **options: Any) -> Iterator[SerialNode]:
    node = SerialNode(path, **options)
    stop = threading.Event()
    thread = threading.Thread(target=node.run, args=(stop,))
    thread.start()
    try:
        yield node
    finally:
        stop.set()
        thread.join()


def laser(path: Path, **options: Any) -> Laser:
    return Laser(**{"device": str(path), "silence": 10.0} | options)


@pytest.mark.parametrize("mode", ["continuous", "request"])
def test_values_come_in_metres(tmp_path: Path, mode: str) -> None:
    path = tmp_path / "laser"
    with sensor(path, displacement=lambda: 123.4e-6, mode=mode):
        with LaserLine(laser(path, mode=mode)) as line:
            assert line.wait(20, EVER)
            assert line.displacement == pytest.approx(123.4e-6, abs=1e-12)
            assert (line.garbled, line.complaint) == (0, "")
            block, frame = Displacement(line), np.full((4, 1), np.nan)
            block.process(frame)
    np.testing.assert_allclose(frame, 123.4e-6)


@pytest.mark.parametrize("mode", ["continuous", "request"])
def test_garbage_and_half_lines_are_counted_and_borne(tmp_path: Path, mode: str) -> None:
    path = tmp_path / "laser"
    with sensor(path, displacement=lambda: 1e-6, mode=mode) as node:
        with LaserLine(laser(path, mode=mode)) as line:
            assert line.wait(5, EVER)
            for noise in (b"\xff\xfe\r", b"M1,+0", b"\r" * 3, b"TG,1,garbage!\r", b"x" * 300):
                node.spill(noise)
                assert line.wait(line.readings + 5, EVER)
            assert line.displacement == pytest.approx(1e-6)
            assert line.garbled >= 2
            assert "the laser sensor says" in line.complaint


def test_a_sensor_that_falls_silent_has_no_value_and_has_one_again(tmp_path: Path) -> None:
    now = [0.0]
    path = tmp_path / "laser"
    with sensor(path, displacement=lambda: 1e-6) as node:
        with LaserLine(laser(path, silence=0.1), now=lambda: now[0]) as line:
            assert line.wait(5, EVER)
            node.is_silent = True
            while line.wait(line.readings + 1, 0.1):
                pass
            assert line.displacement == pytest.approx(1e-6)
            now[0] += 0.11
            assert math.isnan(line.displacement)
            node.is_silent = False
            assert line.wait(line.readings + 1, EVER)
            assert line.displacement == pytest.approx(1e-6)


def test_a_target_out_of_range_is_nan(tmp_path: Path) -> None:
    path = tmp_path / "laser"
    with sensor(path, displacement=lambda: 1.0), LaserLine(laser(path)) as line:
        assert line.wait(2, EVER)
        assert math.isnan(line.displacement)


def test_unplugged_it_has_no_value_and_plugged_in_it_has_one_again(tmp_path: Path) -> None:
    path = tmp_path / "laser"
    with sensor(path, displacement=lambda: 1e-6):
        line = LaserLine(laser(path))
        line.__enter__()
        assert line.wait(5, EVER)
    with sensor(path, displacement=lambda: 2e-6):
        assert line.wait(line.readings + 20, EVER)
        assert line.displacement == pytest.approx(2e-6)
        assert "has gone" in line.complaint
        assert line.garbled == 0
        line.__exit__()


def test_a_request_it_does_not_take_is_refused_by_it(tmp_path: Path) -> None:
    path = tmp_path / "laser"
    with (
        sensor(path, displacement=lambda: 1e-6, mode="request"),
        LaserLine(laser(path, mode="request", output=2)) as line,
    ):
        assert line.wait(2, EVER)
        assert math.isnan(line.displacement)


def test_a_port_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match=r"serial:Serial cannot open laser.device '.*nowhere'"):
        LaserLine(laser(tmp_path / "nowhere")).__enter__()
    with pytest.raises(ValueError, match="laser.port, serial:Parallel: module serial has no Parallel"):
        LaserLine(laser(tmp_path, port="serial:Parallel")).__enter__()


def test_a_port_that_another_program_has_is_refused_and_is_free_when_that_has_ended(tmp_path: Path) -> None:
    path = tmp_path / "laser"
    with sensor(path, displacement=lambda: 1e-6):
        with LaserLine(laser(path)), pytest.raises(LinkError, match="laser.device '.*laser' is in use by another"):
            LaserLine(laser(path)).__enter__()
        with LaserLine(laser(path)) as line:
            assert line.wait(5, EVER)


def test_only_the_output_that_is_wanted_is_read() -> None:
    line = LaserLine(Laser(output=2))
    line.take(b"TG,1,+00.0010\rTG,2,+00.0020\r")
    assert (line.readings, line.displacement) == (1, pytest.approx(2e-6))
