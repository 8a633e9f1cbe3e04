"""The force sensor's records: zero force and drift at rest, faults by name; within a graph as over the wire."""

from typing import Any

import numpy as np
import pytest

from firmware_sim.force_sensor_block import ForceSensor as SimulatedSensor
from stagectl.robot.force_config import ForceSensor
from stagectl.robot.force_inbox import ForceInbox
from stagectl.robot.wired_force import WiredForce
from stagectl.wire.force_sensor import Record, Status

STEP = 0.002
ZERO = np.array([3.0, -4.0, 5.0, 0.3, -0.4, 0.5])


class Sensor:
    """An inbox and a clock; `send` lets so many seconds of records pass."""

    def __init__(self) -> None:
        self.reasons, self.now, self.counter = list[str](), 0.0, 0
        self.inbox = ForceInbox(ForceSensor(), self.reasons.append)

    def send(self, seconds: float, force: float = 0.0, status: int = 0, shake: float = 0.0) -> None:
        for n in range(round(seconds / STEP)):
            self.now, self.counter = self.now + STEP, self.counter + 1
            wrench = ZERO + (-1) ** n * shake
            wrench[1] += force
            self.inbox.accept(Record(self.counter, self.counter, status, wrench), self.now)
            self.inbox.watch(self.now)

    def wait(self, seconds: float) -> None:
        self.now += seconds
        self.inbox.watch(self.now)

    def rest(self, **given: float) -> None:
        self.inbox.rest(self.now)
        self.send(0.6, **given)
        self.inbox.move()


def watched() -> Sensor:
    sensor = Sensor()
    sensor.rest()
    sensor.inbox.begin(sensor.now)
    return sensor


def test_zero_force_is_the_mean_of_a_rest() -> None:
    sensor = Sensor()
    sensor.send(0.1)
    assert not sensor.inbox.is_tared
    np.testing.assert_allclose(sensor.inbox.wrench, ZERO)
    sensor.rest(shake=1.0)
    np.testing.assert_allclose(sensor.inbox.zero, ZERO, atol=0.01)
    sensor.send(0.1, force=7.0)
    np.testing.assert_allclose(sensor.inbox.wrench, [0, 7, 0, 0, 0, 0], atol=0.01)
    assert sensor.inbox.is_good


def test_what_shakes_is_no_rest() -> None:
    sensor = Sensor()
    sensor.rest(shake=3.0)
    assert not sensor.inbox.is_tared
    assert sensor.inbox.fault == "restless"
    assert sensor.reasons == ["the force sensor is restless: force varies by 3 N rms, must be <= 2 N"]


def test_drift_shows_at_the_next_rest_and_too_much_is_a_fault() -> None:
    sensor = watched()
    sensor.rest(force=4.0)
    np.testing.assert_allclose(sensor.inbox.drift[:3], [0, 4, 0], atol=1e-9)
    assert not sensor.reasons
    sensor.rest(force=6.0)
    assert sensor.inbox.fault == "drifted"
    assert sensor.reasons[0].startswith("the force sensor has drifted: at rest by 0, 6, 0 N, must be <= 5 N")


def test_silence_is_a_fault_while_it_is_watched() -> None:
    sensor = Sensor()
    sensor.rest()
    sensor.wait(1.0)
    assert not sensor.reasons
    sensor.inbox.begin(sensor.now)
    sensor.wait(0.015)
    assert not sensor.reasons
    sensor.wait(0.01)
    assert (sensor.inbox.fault, len(sensor.reasons)) == ("silent", 1)
    sensor.wait(1.0)
    assert len(sensor.reasons) == 1  # told once


@pytest.mark.parametrize("how", [{"force": 500.0}, {"status": int(Status.ERROR | Status.GAGE_OUT_OF_RANGE)}])
def test_saturation_for_longer_is_a_fault_and_counts_for_nothing(how: dict[str, Any]) -> None:
    sensor = watched()
    sensor.send(0.01, **how)
    assert not sensor.inbox.is_good
    assert np.abs(sensor.inbox.wrench).max() < 1e-9  # the last good one stays
    sensor.send(STEP)
    assert sensor.inbox.is_good
    sensor.send(0.03, **how)
    assert sensor.inbox.fault == "saturated"
    assert "the force sensor is saturated: for 0.02 s" in sensor.reasons[0]


def test_any_other_error_is_a_fault() -> None:
    sensor = watched()
    sensor.send(STEP, status=int(Status.ERROR) | 4)
    assert sensor.reasons == ["the force sensor is faulty: status 0x80000004"]


def test_lost_and_late_records_are_counted() -> None:
    sensor = watched()
    sensor.counter += 3
    sensor.send(STEP)
    sensor.counter -= 2
    sensor.send(STEP)
    assert (sensor.inbox.counts.lost, sensor.inbox.counts.late) == (3, 1)


def run(seconds: float, resting: np.ndarray, **options: Any) -> tuple[WiredForce, list[str], np.ndarray, np.ndarray]:
    """Run the simulated sensor and the block behind it, 2000 samples/s, with a push of 30 N along x but at rest."""
    frames, reasons = round(seconds * 2_000), list[str]()
    sensor, wired = SimulatedSensor(**options), WiredForce(ForceSensor(), reasons.append)
    sensor.prepare(2_000.0, frames)
    wired.prepare(2_000.0, frames)
    told = [np.empty((frames, port.width)) for port in sensor.outputs]
    push = np.zeros((frames, 3))
    push[:, 0] = np.where(resting[:, 0] > 0, 0.0, 30.0)
    sensor.process(push, np.zeros((frames, 3)), *told)
    wired.start()
    measured, sample, status = told
    out = [np.empty((frames, port.width)) for port in wired.outputs]
    wired.process(sample, status, measured, resting, *out)
    return wired, reasons, out[0], out[3][:, 0]


def test_in_a_graph_force_is_right_after_a_rest_and_drift_stops_the_robot() -> None:
    resting = np.zeros((6_000, 1))
    resting[:1_400] = resting[4_400:] = 1.0
    wired, reasons, force, valid = run(3.0, resting)
    assert not reasons
    assert valid[:900].max() == 0.0 < valid[1_300:].min()
    np.testing.assert_allclose(force[2_000:4_000].mean(axis=0), [30, 0, 0], atol=0.5)
    assert 0.0 < np.abs(wired.inbox.drift).max() < 0.5
    wired, reasons, _, valid = run(3.0, resting, step_at=1.5)
    assert wired.inbox.fault == "drifted"
    assert valid[-1] == 0.0
    assert "drifted: at rest by" in reasons[0]


@pytest.mark.parametrize(("option", "name"), [("silent", "silent"), ("stuck", "saturated")])
def test_in_a_graph_faults_hold_the_robot_by_name(option: str, name: str) -> None:
    resting = np.zeros((4_000, 1))
    resting[:1_400] = 1.0
    wired, reasons, _, valid = run(2.0, resting, **{option: 1.5})
    assert wired.inbox.fault == name
    assert f"the force sensor is {name}" in reasons[0]
    assert valid[2_990] == 1.0
    assert valid[-1] == 0.0
