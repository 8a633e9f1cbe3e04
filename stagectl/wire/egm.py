"""The messages of ABB's Externally Guided Motion over UDP: bytes <-> SI numbers.

The messages are built here from their field numbers, in a pool of their own: a module generated from ABB's file claims
its names in the pool that all programs share, where a second one of another version is refused.  Fields that are left
out are passed over, as protobuf does; `measuredForce` is one, since versions 1 and 2 give its numbers other meanings.
"""

import math
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.message import DecodeError

from rigkit.wire.layout import GarbledError, WireError
from stagectl.wire.robot import Command, Motion, Report

MODULUS = 1 << 32
"""Of the counters."""
_MM = 1e-3
_MS = 1e-3


_CORRECTION, _DATA, _MOTORS_ON, _MOTORS_OFF, _RAPID_STOPPED, _RAPID_RUNNING = 3, 2, 1, 2, 1, 2
_MESSAGES = {
    "EgmHeader": "seqno:1:u tm:2:u mtype:3:i",
    "EgmCartesian": "x:1:d y:2:d z:3:d",
    "EgmQuaternion": "u0:1:d u1:2:d u2:3:d u3:4:d",
    "EgmPose": "pos:1:EgmCartesian orient:2:EgmQuaternion",
    "EgmJoints": "joints:1:*",
    "EgmPlanned": "joints:1:EgmJoints cartesian:2:EgmPose",
    "EgmFeedBack": "joints:1:EgmJoints cartesian:2:EgmPose",
    "EgmState": "state:1:i",
    "EgmRobot": "header:1:EgmHeader feedBack:2:EgmFeedBack planned:3:EgmPlanned motorState:4:EgmState"
    " mciState:5:EgmState rapidExecState:8:EgmState",
    "EgmSensor": "header:1:EgmHeader planned:2:EgmPlanned",
}
"""Name, number and kind of each field [ABB egm.proto, in RobotWare's folder utility/Template/EGM]: u unsigned, i enum,
d double, * doubles in a row, or a message.  EgmState stands for the three messages of one enum."""


def _classes() -> dict[str, Any]:
    kinds = descriptor_pb2.FieldDescriptorProto
    numbers = {"u": kinds.TYPE_UINT32, "i": kinds.TYPE_INT32, "d": kinds.TYPE_DOUBLE, "*": kinds.TYPE_DOUBLE}
    file = descriptor_pb2.FileDescriptorProto(name="guided_motion.proto", package="abb.egm", syntax="proto2")
    for name, fields in _MESSAGES.items():
        message = file.message_type.add(name=name)
        for field, number, kind in (each.split(":") for each in fields.split()):
            label = kinds.LABEL_REPEATED if kind == "*" else kinds.LABEL_OPTIONAL
            made = message.field.add(name=field, number=int(number), label=label)
            if kind in numbers:
                made.type = numbers[kind]
            else:
                made.type, made.type_name = kinds.TYPE_MESSAGE, f".abb.egm.{kind}"
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return {name: message_factory.GetMessageClass(pool.FindMessageTypeByName(f"abb.egm.{name}")) for name in _MESSAGES}


_CLASSES = _classes()


class Egm:
    """Guided motion's messages as a `RobotWire`: torques and the robot's program have lines of their own."""

    modulus, is_whole = MODULUS, False

    def read(self, data: bytes) -> Report:
        """Return a report, as `unpack_report` does."""
        return unpack_report(data)

    def write(self, command: Command, report: Report) -> bytes:  # noqa: ARG002 (its answers have a counter of their own)
        """Return a command's bytes, as `pack_command` does."""
        return pack_command(command)

    def refusal(self, wanted: np.ndarray) -> str:  # noqa: ARG002 (finite numbers always fit)
        """Refuse nothing of `wanted`: angles, shape (6,), rad, or a pose, shape (7,), m and 1."""
        return ""

    def forget(self) -> None:
        """Remember nothing."""


def pack_report(report: Report) -> bytes:
    """Return a report's bytes."""
    message = _CLASSES["EgmRobot"]()
    _head(message, report.counter, report.time, _DATA)
    message.feedBack.joints.joints.extend(np.degrees(report.joint_angle).tolist())
    if np.isfinite(report.pose).all():
        _fill_pose(message.feedBack.cartesian, report.pose)
    message.planned.joints.joints.extend(np.degrees(report.planned_angle).tolist())
    message.motorState.state = _MOTORS_ON if report.motors_on else _MOTORS_OFF
    message.mciState.state = int(report.motion)
    message.rapidExecState.state = _RAPID_RUNNING if report.program_runs else _RAPID_STOPPED
    return bytes(message.SerializeToString())


def unpack_report(data: bytes) -> Report:
    """Return a report; `GarbledError` where the bytes are none, or a number in it is missing or not finite."""
    message = _parsed("EgmRobot", data)
    motion = message.mciState.state
    if motion not in Motion.__members__.values():
        raise GarbledError(f"EgmRobot: mciState is {motion}, must be 0 to 3")
    feedback = message.feedBack
    return Report(
        message.header.seqno,
        _MS * message.header.tm,
        _angles("EgmRobot feedBack", feedback.joints),
        _angles("EgmRobot planned", message.planned.joints),
        _pose(feedback.cartesian) if feedback.HasField("cartesian") else np.full(7, np.nan),
        message.motorState.state == _MOTORS_ON,
        message.rapidExecState.state == _RAPID_RUNNING,
        Motion(motion),
    )


def pack_command(command: Command) -> bytes:
    """Return a command's bytes; `WireError` where a number is not finite, or it asks for nothing."""
    message = _CLASSES["EgmSensor"]()
    _head(message, command.counter, command.time, _CORRECTION)
    wanted = command.pose if command.joint_angle is None else command.joint_angle
    if wanted is None or not np.isfinite(wanted).all():
        raise WireError(f"EgmSensor: {wanted} cannot be sent, must be finite angles or a pose")
    if command.joint_angle is not None:
        message.planned.joints.joints.extend(np.degrees(wanted).tolist())
    else:
        _fill_pose(message.planned.cartesian, wanted)
    return bytes(message.SerializeToString())


def unpack_command(data: bytes) -> Command:
    """Return a command; `GarbledError` where the bytes are none."""
    message = _parsed("EgmSensor", data)
    planned, counter, time = message.planned, message.header.seqno, _MS * message.header.tm
    if planned.HasField("joints"):
        return Command(counter, time, joint_angle=_angles("EgmSensor planned", planned.joints))
    if planned.HasField("cartesian"):
        return Command(counter, time, pose=_pose(planned.cartesian))
    raise GarbledError("EgmSensor: asks for nothing, must have joints or a pose")


def _head(message: Any, counter: int, time: float, kind: int) -> None:
    message.header.seqno, message.header.mtype = counter % MODULUS, kind
    message.header.tm = round(time / _MS) % MODULUS


def _parsed(name: str, data: bytes) -> Any:
    message = _CLASSES[name]()
    try:
        message.ParseFromString(data)
    except DecodeError as fault:
        raise GarbledError(f"{name}: {len(data)} bytes are no such message: {fault}") from None
    if not (message.HasField("header") and message.header.HasField("seqno")):
        raise GarbledError(f"{name}: has no counter")
    return message


def _angles(name: str, joints: Any) -> np.ndarray:
    values = joints.joints
    if len(values) != 6 or not all(map(math.isfinite, values)):
        raise GarbledError(f"{name}: joints are {list(values)}, must be 6 finite numbers")
    return np.asarray(np.radians(values))


def _fill_pose(message: Any, pose: np.ndarray) -> None:
    x, y, z, w, i, j, k = pose.tolist()
    message.pos.x, message.pos.y, message.pos.z = x / _MM, y / _MM, z / _MM
    message.orient.u0, message.orient.u1, message.orient.u2, message.orient.u3 = w, i, j, k


def _pose(message: Any) -> np.ndarray:
    place, turn = message.pos, message.orient
    pose = np.array([place.x * _MM, place.y * _MM, place.z * _MM, turn.u0, turn.u1, turn.u2, turn.u3])
    if not (np.isfinite(pose).all() and abs(math.hypot(*pose[3:]) - 1) < 1e-3):
        raise GarbledError(f"a pose is {pose}, must be finite, with a unit quaternion")
    return pose
