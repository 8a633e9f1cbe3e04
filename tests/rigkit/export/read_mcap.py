"""An MCAP file read as other programs read it: by mcap, and by protobuf from the schemas in the file alone."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader

from ctlblocks.recording import Recording


def read_mcap(path: Path, dtype: str) -> dict[str, Recording]:
    """Return the recording of every topic; times must be those of even samples from 0 on."""
    found, times = {}, {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            assert (schema.encoding, channel.message_encoding) == ("protobuf", "protobuf")
            made, rows = _message_class(schema.name, schema.data), []
            names = [field.name for field in made.DESCRIPTOR.fields]
            times[channel.topic] = []
            for _, _, message in reader.iter_messages([channel.topic], log_time_order=False):
                values = made.FromString(message.data)
                rows.append([getattr(values, name) for name in names])
                times[channel.topic].append((message.log_time, message.publish_time, message.sequence))
            rate, units = float(channel.metadata["rate"]), json.loads(channel.metadata["units"])
            for number, row in enumerate(times[channel.topic]):
                assert row == (round(1e9 * number / rate), round(1e9 * number / rate), number)
            data = np.array(rows, dtype)
            found[channel.topic] = Recording(
                tuple(names), tuple(units[name] for name in names), rate, data, channel.metadata
            )
    return found


def attachments(path: Path) -> dict[str, bytes]:
    """Return the files that are in it."""
    with path.open("rb") as file:
        return {each.name: each.data for each in make_reader(file).iter_attachments()}


def _message_class(name: str, schema: bytes) -> Any:
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))
