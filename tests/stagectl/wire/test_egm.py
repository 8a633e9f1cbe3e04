"""Guided motion's messages: there and back, against an independent reading of them, and bytes that are none."""

import numpy as np
import pytest

from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.egm import pack_command, pack_report, unpack_command, unpack_report
from stagectl.wire.robot import Command, Motion, Report

ANGLES = np.radians([10.0, -20.0, 30.0, 0.0, 45.0, 90.0])
POSE = np.array([0.515, -0.1, 0.712, 0.5, 0.5, -0.5, 0.5])
REPORT = Report(7, 1.236, ANGLES, ANGLES + 0.01, POSE, motors_on=True, program_runs=False, motion=Motion.STOPPED)


def test_a_report_comes_back_as_it_went() -> None:
    found = unpack_report(pack_report(REPORT))
    assert (found.counter, found.time, found.motion) == (7, 1.236, Motion.STOPPED)
    assert (found.motors_on, found.program_runs) == (True, False)
    for name in ("joint_angle", "planned_angle", "pose"):
        np.testing.assert_allclose(getattr(found, name), getattr(REPORT, name), atol=1e-14)


def test_commands_come_back_as_they_went() -> None:
    joints = unpack_command(pack_command(Command(2**32 + 5, 0.5, joint_angle=ANGLES)))
    pose = unpack_command(pack_command(Command(6, 0.5, pose=POSE)))
    assert joints.counter == 5
    np.testing.assert_allclose(joints.joint_angle, ANGLES, atol=1e-14)
    np.testing.assert_allclose(pose.pose, POSE, atol=1e-14)
    assert joints.pose is None
    assert pose.joint_angle is None


def test_another_client_reads_and_writes_the_same_messages() -> None:
    """ABBRobotEGM's messages were generated from ABB's own file."""
    package = pytest.importorskip("ABBRobotEGM._egm_protobuf.egm_pb2", reason="ABBRobotEGM is not installed")
    theirs = package.EgmRobot()
    theirs.ParseFromString(pack_report(REPORT))
    assert theirs.header.seqno == 7
    assert theirs.header.mtype == package.EgmHeader.MSGTYPE_DATA
    assert theirs.header.tm == 1236
    assert theirs.mciState.state == package.EgmMCIState.MCI_STOPPED
    assert theirs.motorState.state == package.EgmMotorState.MOTORS_ON
    assert theirs.rapidExecState.state == package.EgmRapidCtrlExecState.RAPID_STOPPED
    np.testing.assert_allclose(theirs.feedBack.joints.joints, np.degrees(ANGLES))
    place, turn = theirs.feedBack.cartesian.pos, theirs.feedBack.cartesian.orient
    np.testing.assert_allclose([place.x, place.y, place.z], 1e3 * POSE[:3])
    np.testing.assert_allclose([turn.u0, turn.u1, turn.u2, turn.u3], POSE[3:])
    assert unpack_report(theirs.SerializeToString()).counter == 7
    asked = package.EgmSensor()
    asked.header.seqno, asked.header.mtype = 9, package.EgmHeader.MSGTYPE_CORRECTION
    asked.planned.joints.joints.extend(np.degrees(ANGLES))
    np.testing.assert_allclose(unpack_command(asked.SerializeToString()).joint_angle, ANGLES)
    asked.ParseFromString(pack_command(Command(3, 0.0, pose=POSE)))
    assert asked.planned.cartesian.pos.x == pytest.approx(515.0)
    assert asked.header.mtype == package.EgmHeader.MSGTYPE_CORRECTION


def test_bytes_of_no_message_are_garbled() -> None:
    good = pack_report(REPORT)
    for bad in (b"", b"\xff\xff", good[:-3], b"\x08" + good):
        with pytest.raises(GarbledError):
            unpack_report(bad)
    with pytest.raises(GarbledError, match="asks for nothing"):
        unpack_command(pack_report(REPORT)[:0] + b"\x0a\x02\x08\x05")


def test_numbers_that_are_none_are_neither_sent_nor_believed() -> None:
    nan = np.full(6, np.nan)
    with pytest.raises(WireError, match="cannot be sent"):
        pack_command(Command(1, 0.0, joint_angle=nan))
    with pytest.raises(WireError, match="cannot be sent"):
        pack_command(Command(1, 0.0))
    with pytest.raises(GarbledError, match="feedBack: joints are"):
        unpack_report(pack_report(Report(1, 0.0, nan, ANGLES, POSE)))
    with pytest.raises(GarbledError, match="unit quaternion"):
        unpack_report(pack_report(Report(1, 0.0, ANGLES, ANGLES, 2 * POSE)))


def test_any_damage_is_garbled_or_still_finite() -> None:
    rng, good = np.random.default_rng(1), pack_report(REPORT)
    for _ in range(500):
        bad = bytearray(good)
        bad[rng.integers(len(bad))] ^= 1 << rng.integers(8)
        try:
            found = unpack_report(bytes(bad))
        except GarbledError:
            continue
        assert np.isfinite(found.joint_angle).all()
