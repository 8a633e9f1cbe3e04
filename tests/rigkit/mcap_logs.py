"""MCAP files as other programs log them: topics in JSON, protobuf and ROS 2, written by the libraries themselves."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import struct_pb2, wrappers_pb2
from mcap import writer as plain
from mcap_protobuf import writer as protobuf
from mcap_ros2 import writer as ros2

Messages = Sequence[tuple[int, Any]]
"""Log times, ns, and what was logged."""

JOINTS = """std_msgs/Header header
string[] name
float64[] position
float32[3] effort
bool moving
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def times(count: int, rate: float, start: float = 1.7e9) -> list[int]:
    """Return even log times, ns."""
    return [round(start * 1e9) + round(n * 1e9 / rate) for n in range(count)]


def json_log(
    path: Path,
    topics: Mapping[str, Messages],
    metadata: Mapping[str, str] | None = None,
    encoding: str = "json",
    **options: Any,
) -> Path:
    """Write JSON objects; topics are interleaved by time."""
    with path.open("wb") as file:
        writer = plain.Writer(file, **options)
        writer.start()
        channels = {topic: writer.register_channel(topic, encoding, 0, dict(metadata or {})) for topic in topics}
        everything = sorted((time, topic, n) for topic, each in topics.items() for n, (time, _) in enumerate(each))
        for time, topic, n in everything:
            writer.add_message(channels[topic], time, json.dumps(topics[topic][n][1]).encode(), time)
        writer.finish()
    return path


def protobuf_log(path: Path, numbers: Sequence[float], rate: float) -> Path:
    """Write a plain number, and a structure of several kinds, at the same times."""
    with path.open("wb") as file, protobuf.Writer(file) as writer:
        for time, number in zip(times(len(numbers), rate), numbers, strict=True):
            writer.write_message("/gauge", wrappers_pb2.DoubleValue(value=number), time, time)
            held = struct_pb2.Struct()
            held.update({"list": [1.0, number], "text": "a"})
            writer.write_message("/held", held, time, time)
    return path


def ros2_log(path: Path, position: np.ndarray, rate: float) -> Path:
    """Write joint states: positions, shape (messages, joints), rad; efforts are 2, 3 and 4 times the first."""
    with path.open("wb") as file:
        writer = ros2.Writer(file)
        schema = writer.register_msgdef("test_msgs/msg/Joints", JOINTS)
        for n, (time, row) in enumerate(zip(times(len(position), rate), position, strict=True)):
            header = {"stamp": {"sec": time // 10**9, "nanosec": time % 10**9}, "frame_id": "base"}
            effort = [2 * row[0], 3 * row[0], 4 * row[0]]
            names = [f"joint_{k}" for k in range(len(row))]
            message = {"header": header, "name": names, "position": list(row), "effort": effort, "moving": n % 2 == 1}
            writer.write_message("/joint_states", schema, message, time)
        writer.finish()
    return path
