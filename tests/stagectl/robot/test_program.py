"""The program beside guided motion and the torque signals, on loopback."""

import numpy as np
import pytest

from stagectl.link.bus import LinkError
from stagectl.robot.config import Robot
from stagectl.robot.program import RobotProgram, TorqueSignals


def signals() -> TorqueSignals:
    return TorqueSignals(Robot(), "127.0.0.1", lambda: 0.0)


def test_signals_are_read_however_the_line_is_cut() -> None:
    made = signals()
    line = b"0.004," + b",".join(b"%d" % n for n in range(10, 22)) + b"\n"
    for at in range(0, 3 * len(line), 5):
        made.take((3 * line)[at : at + 5], 0.0)
    assert (made.samples.written, made.garbled) == (3, 0)
    np.testing.assert_allclose(made.newest[1:7], np.radians(np.arange(10, 16)))
    np.testing.assert_array_equal(made.newest[7:], np.arange(16, 22))


@pytest.mark.parametrize(("clock", "late"), [(0.0, 0.0), (1e4, -1e4)])
def test_a_line_with_a_clock_of_its_own_is_set_by_the_sample_that_came_quickest(clock: float, late: float) -> None:
    made = signals()
    for n, way in enumerate((0.003, 0.001, 0.002)):
        made.take(b"%.6f" % (clock + n) + b",0" * 12 + b"\n", 100.0 + n + way)
    assert made.late(100.001) == pytest.approx(late)


@pytest.mark.parametrize("line", [b"rubbish", b"1,2,3", b"nan" + b",1" * 12, b"1," * 12 + b"inf", b"\xff" * 3_000])
def test_lines_that_are_none_are_counted(line: bytes) -> None:
    made = signals()
    made.take(line + b"\n", 0.0)
    assert (made.samples.written, made.garbled) == (0, 1)
    assert np.isnan(made.newest).all()


def test_a_line_that_is_back_begins_anew() -> None:
    made = signals()
    made.take(b"0.1,2,3", 0.0)
    made.lose()
    made.take(b"0" + b",1" * 12 + b"\n", 0.0)
    assert (made.samples.written, made.garbled) == (1, 0)


def test_a_program_that_is_not_there_is_named() -> None:
    with pytest.raises(LinkError, match="the robot's program on 127.0.0.1:9 cannot be connected to"):
        RobotProgram(Robot(commands=9), "127.0.0.1")
