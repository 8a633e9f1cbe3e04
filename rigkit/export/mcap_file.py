"""Recordings as MCAP, a topic each and a protobuf message a sample: for PlotJuggler, Foxglove and their libraries."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorSet

from ctlblocks.recording import Recording
from rigkit.export.optional import optional

PACKAGE = "vibrostage"
"""Of the messages."""
BLOCK = 16_384
"""Samples that are made messages at a time."""
_KINDS = {
    "float32": (FieldDescriptorProto.TYPE_FLOAT, 5, "<f4"),
    "float64": (FieldDescriptorProto.TYPE_DOUBLE, 1, "<f8"),
}
"""Type of a field, its wire type and its bytes: https://protobuf.dev/programming-guides/encoding."""


def write_mcap(
    path: Path, recordings: Iterable[tuple[str, Recording]], about: Mapping[str, str], beside: Sequence[Path] = ()
) -> None:
    """Write recordings, every sample to its last bit, with units and rate in the metadata of each topic.

    The time of a message is counted from the first sample of its own recording, in ns, so that shots lie on top of
    each other.

    Parameters
    ----------
    path : Path
        Written in place.
    recordings : iterable of (topic, Recording)
    about : mapping of str to str
        Where it all comes from.
    beside : sequence of Path
        Files that go along whole, as attachments: the configuration, the events.

    Raises
    ------
    ValueError : mcap is not installed, or two channels have one name as protobuf writes names.
    """
    with path.open("wb") as file:
        writer = optional("mcap.writer").Writer(file)
        writer.start(profile="", library=about.get("exported_by", PACKAGE))
        writer.add_metadata("about", dict(about))
        for attached in beside:
            kind = "application/x-hdf5" if attached.suffix == ".h5" else "text/plain"
            writer.add_attachment(0, 0, attached.name, kind, attached.read_bytes())
        schemas: dict[tuple[str, ...], int] = {}
        for topic, record in recordings:
            _write_topic(writer, topic, record, schemas)
        writer.finish()


def field_names(names: Sequence[str]) -> list[str]:
    """Return the names of channels as protobuf writes them: letters, digits and "_", no digit first.

    Examples
    --------
    >>> field_names(["drive_1", "2nd coil"])
    ['drive_1', '_2nd_coil']
    """
    plain = [re.sub(r"^(?=\d)", "_", re.sub(r"[^A-Za-z0-9_]", "_", name)) for name in names]
    if len(set(plain)) < len(plain):
        raise ValueError(f"the channels {', '.join(names)} become {', '.join(plain)}, must differ")
    return plain


def _write_topic(writer: Any, topic: str, record: Recording, schemas: dict[tuple[str, ...], int]) -> None:
    names, kind = field_names(record.names), record.data.dtype.name
    key = (kind, *names)
    if key not in schemas:
        message = f"Sample{len(schemas) + 1}"  # readers keep schemas by name, so no two have one
        schemas[key] = writer.register_schema(f"{PACKAGE}.{message}", "protobuf", _schema(message, names, kind))
    units = json.dumps(dict(zip(names, record.units, strict=True)))
    metadata = {**record.provenance, "rate": repr(record.rate), "units": units}
    channel = writer.register_channel(topic, "protobuf", schemas[key], metadata)
    for start in range(0, len(record.data), BLOCK):
        part = record.data[start : start + BLOCK]
        content, size = _messages(part, kind)
        times = np.rint(np.arange(start, start + len(part)) * (1e9 / record.rate)).astype(np.int64).tolist()
        for n, time in enumerate(times):
            writer.add_message(channel, time, content[n * size : (n + 1) * size], time, start + n)


def _schema(message: str, names: Sequence[str], kind: str) -> bytes:
    """Return the description of a message with a field for each channel, as MCAP keeps it."""
    described = FileDescriptorSet()
    file = described.file.add(name=f"{message}.proto", package=PACKAGE, syntax="proto3")
    made = file.message_type.add(name=message)
    for number, name in enumerate(names, start=1):
        made.field.add(name=name, number=number, type=_KINDS[kind][0], label=FieldDescriptorProto.LABEL_OPTIONAL)
    return bytes(described.SerializeToString())


def _messages(data: np.ndarray, kind: str) -> tuple[bytes, int]:
    """Return all samples, shape (samples, channels), any unit, as messages end to end, and the bytes of one."""
    _, wire, number = _KINDS[kind]
    tags = [_varint(field << 3 | wire) for field in range(1, data.shape[1] + 1)]
    parts: list[tuple[str, Any]] = []
    for field, tag in enumerate(tags):
        parts += [(f"tag_{field}", f"V{len(tag)}"), (f"value_{field}", number)]
    whole = np.zeros(len(data), parts)
    for field, tag in enumerate(tags):
        whole[f"tag_{field}"] = np.void(tag)
        whole[f"value_{field}"] = data[:, field]
    return whole.tobytes(), whole.itemsize


def _varint(value: int) -> bytes:
    """Return a whole number >= 0 as protobuf writes it: seven bits a byte, the lowest first."""
    digits = []
    while value >= 0x80:
        digits.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*digits, value])
