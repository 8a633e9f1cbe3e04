"""The benchmark of the wires: what a silence is, whose it was, and what a packet on the wire means.

Guards against silences that are laid to the machine though it ran, and against a port that was closed taken for one.
"""

import struct

import numpy as np
import pytest

from benchmarks.wires.listener import ANSWER, REFUSED, REPORT, kind_of
from benchmarks.wires.silences import MACHINE, OURS, ROBOT, heard

CYCLE = 0.004
REPORTS = 100.0 + CYCLE * np.arange(1000)
ANSWERS = REPORTS + 5e-4
NONE = np.zeros(0)
AWAKE = np.zeros((0, 2))


def without(times: np.ndarray, begin: int, count: int) -> np.ndarray:
    return np.delete(times, np.arange(begin, begin + count))


def test_a_robot_that_is_answered_each_time_has_no_silence() -> None:
    found = heard(REPORTS, ANSWERS, NONE, [AWAKE])
    assert (found.cycles, found.unanswered, found.silences) == (1000, 0, ())
    assert found.largest == pytest.approx(CYCLE)
    assert found.slow == pytest.approx(5e-4)


@pytest.mark.parametrize("count", [1, 3, 10])
def test_a_silence_that_nothing_else_explains_is_our_own(count: int) -> None:
    found = heard(REPORTS, without(ANSWERS, 500, count), NONE, [AWAKE, AWAKE])
    assert found.unanswered == count
    assert [each.whose for each in found.silences] == [OURS] * (count > 1)


def test_one_in_which_a_core_woke_late_is_the_machines() -> None:
    late = np.array([[float(ANSWERS[499]) + 0.003, 0.012]])
    found = heard(REPORTS, without(ANSWERS, 500, 4), NONE, [AWAKE, late])
    assert [(each.whose, each.stood) for each in found.silences] == [(MACHINE, 0.012)]
    a_little = np.array([[float(ANSWERS[499]) + 0.003, 0.002]])
    (other,) = heard(REPORTS, without(ANSWERS, 500, 4), NONE, [a_little]).silences
    assert other.whose == OURS


def test_one_in_which_the_robot_said_nothing_is_its_own() -> None:
    found = heard(without(REPORTS, 500, 4), without(ANSWERS, 500, 4), NONE, [AWAKE])
    assert [each.whose for each in found.silences] == [ROBOT]
    assert found.unanswered == 0


def test_a_port_that_is_closed_is_no_silence() -> None:
    found = heard(REPORTS, without(ANSWERS, 500, 100), REPORTS[500:600] + 1e-5, [AWAKE])
    assert found.silences == ()
    assert found.largest == pytest.approx(CYCLE)


def udp(source: int, to: int) -> bytes:
    return bytes([0x45, *bytes(8), 17, *bytes(10)]) + struct.pack(">HHHH", source, to, 8, 0)


def test_packets_are_told_apart() -> None:
    assert kind_of(udp(5000, 6510), 6510) == REPORT
    assert kind_of(udp(6510, 5000), 6510) == ANSWER
    refused = bytes([0x45, *bytes(8), 1, *bytes(10)]) + bytes([3, 3, *bytes(6)])
    assert kind_of(refused + udp(5000, 6510), 6510) == REFUSED
    assert kind_of(refused + udp(5000, 6511), 6510) is None
