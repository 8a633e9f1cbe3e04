"""Numbers in messages of MCAP files: decoded from JSON, protobuf or ROS 2, and found by the way that leads to each."""

import json
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from rigkit.export.optional import optional

DECODED = "json, protobuf, or cdr with a ros2msg schema"
"""How messages may be encoded."""
PACKAGES = ("mcap.reader", "mcap_protobuf.decoder", "mcap_ros2.decoder")
"""What is needed: the reader first."""

Way = tuple[str, ...]
"""Fields, and numbers from 0 in arrays, that lead to a value."""

_WAY = re.compile(r"(?:\.[^.\[\]]+|\[\d+\])+")


def decoder_of(encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
    """Return what decodes the messages of a channel; None where they are none of `DECODED`.

    Parameters
    ----------
    encoding : str
        Of the messages.
    schema : mcap.records.Schema or None

    Raises
    ------
    ValueError : one of `PACKAGES` is not installed.
    """
    if encoding == "json":
        return json.loads
    for package in PACKAGES[1:]:
        decoder: Callable[[bytes], Any] | None = optional(package).DecoderFactory().decoder_for(encoding, schema)
        if decoder is not None:
            return decoder
    return None


def way_of(text: str) -> Way | None:
    """Return the fields and numbers that lead to a value; None where a text says none.

    Parameters
    ----------
    text : str
        What stands behind the topic.

    Examples
    --------
    >>> way_of(".pose.position.x"), way_of(".effort[2]"), way_of(".effort.2"), way_of("pose")
    (('pose', 'position', 'x'), ('effort', '2'), ('effort', '2'), None)
    """
    return tuple(re.findall(r"[^.\[\]]+", text)) if _WAY.fullmatch(text) else None


def number_at(message: Any, way: Way) -> float:
    """Return the number that a way leads to; a truth is 0 or 1.

    Parameters
    ----------
    message : decoded message
    way : sequence of str

    Raises
    ------
    LookupError : there is none.
    """
    value = message
    for key in way:
        value = _part(value, key)
    if not isinstance(value, int | float):
        raise LookupError(f"{'.'.join(way)} is of {type(value).__name__}")
    return float(value)


def ways_in(message: Any, before: Way = ()) -> Iterator[Way]:
    """Give the ways to all numbers of a message, but to those of texts and bytes.

    Parameters
    ----------
    message : decoded message
    before : tuple of str, optional
        The way to the message itself.

    Yields
    ------
    tuple of str
    """
    if isinstance(message, int | float):
        yield before
    elif not isinstance(message, str | bytes | None):
        for key, value in _parts(message):
            yield from ways_in(value, (*before, key))


def _part(value: Any, key: str) -> Any:
    """Return what is in a message under a key, or in an array at a number."""
    if hasattr(value, "DESCRIPTOR"):  # protobuf's: its Struct is a mapping, too
        return getattr(value, value.DESCRIPTOR.fields_by_name[key].name)
    if isinstance(value, Mapping):
        return value[key]
    if isinstance(value, int | float | str | bytes | None):
        raise LookupError(f"{value!r} has no parts")
    if not hasattr(value, "__getitem__"):
        return getattr(value, key, None)
    if not key.isdecimal():
        raise LookupError(f"an array has no {key!r}")
    return value[int(key)]


def _parts(message: Any) -> Iterator[tuple[str, Any]]:
    if hasattr(message, "DESCRIPTOR"):
        for field in message.DESCRIPTOR.fields:
            value = getattr(message, field.name)
            is_one = field.containing_oneof is not None or hasattr(value, "DESCRIPTOR")
            if not is_one or message.HasField(field.name):
                yield field.name, value
    elif isinstance(message, Mapping):
        yield from ((str(key), value) for key, value in message.items())
    elif hasattr(message, "__getitem__"):
        yield from ((str(place), value) for place, value in enumerate(message))
    else:
        yield from ((name, getattr(message, name)) for name in getattr(message, "__slots__", ()))
