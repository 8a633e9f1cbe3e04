"""MCAP logs of anybody's as signals, through mcap: numbers in the messages of topics, at the times they were logged."""

import itertools
import json
import math
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks.recording import RecordingError
from rigkit.even_time import STEADY, UNEVEN
from rigkit.export.optional import optional
from rigkit.foreign_stream import Signals
from rigkit.log_times import EvenLog
from rigkit.mcap_message import DECODED, PACKAGES, Way, decoder_of, number_at, way_of, ways_in

SUFFIXES = (".mcap",)
MOST = 1000
"""Numbers in a message of a topic of which nobody says which are wanted."""


@dataclass
class _Topic:
    """What was read of a topic: times, ns, and numbers, message after message; `ways` None until the first."""

    path: Path
    name: str
    ways: list[Way] | None
    metadata: Mapping[str, str] = field(default_factory=dict)
    times: "array[int]" = field(default_factory=lambda: array("Q"))
    numbers: "array[float]" = field(default_factory=lambda: array("d"))

    def take(self, time: int, message: Any) -> None:
        if self.ways is None:
            self.ways = list(itertools.islice(ways_in(message), MOST + 1))
            if len(self.ways) > MOST:
                raise RecordingError(f"{self.path}: {self.name} has more than {MOST} numbers, must be named")
        for way in self.ways:
            try:
                self.numbers.append(number_at(message, way))
            except (LookupError, OverflowError):
                there = ", ".join(".".join(each) for each in itertools.islice(ways_in(message), 20)) or "none"
                raise RecordingError(
                    f"{self.path}: {self.name} has no number {'.'.join(way)} in message {len(self.times) + 1}; "
                    f"there are {there}"
                ) from None
        self.times.append(time)

    def even(self, first: int, rate: float | None) -> EvenLog:
        """Return its samples; times are counted from `first`, ns."""
        time = (np.frombuffer(self.times, np.uint64) - np.uint64(first)).astype(float) * 1e-9
        said = self.metadata.get("rate", "")
        return EvenLog.of(f"{self.path}: {self.name}", time, rate or _number(said))

    def values(self) -> np.ndarray:
        """Return its numbers, shape (messages, ways)."""
        return np.frombuffer(self.numbers).reshape(len(self.times), -1)

    def unit(self, way: Way) -> str:
        try:
            units = json.loads(self.metadata.get("units", "{}"))
        except ValueError:
            return "1"
        unit = units.get(".".join(way)) if isinstance(units, dict) else None
        return unit if isinstance(unit, str) else "1"


def mcap_signals(path: Path, channels: Sequence[str] | None, rate: float | None) -> Signals:
    """Open an MCAP file; all that is wanted of it is read at once.

    Topics that were logged beside each other are laid on the samples that they have in common, to half a sample.

    Parameters
    ----------
    path : Path
    channels : sequence of str or None
        "/topic.field", "/topic.field.field" or "/topic.field[2]", whose name is "/topic.field.2"; None: every number
        in every topic.
    rate : float or None, samples/s
        Where the times tell it too coarsely.

    Raises
    ------
    RecordingError : a damaged file, no such topic or number, another encoding, times that are not even, several rates.
    ValueError : mcap, or what decodes messages, is not installed.
    """
    library, *_ = [optional(package) for package in PACKAGES]
    with path.open("rb") as file, _readable(path):
        reader = library.make_reader(file, validate_crcs=True)
        columns = None if channels is None else [_column(path, channel, _topics(reader)) for channel in channels]
        topics = _read(path, reader, columns)
    if columns is None:
        columns = [(topic.name, way) for topic in topics.values() for way in topic.ways or ()]
        topics = {name: topics[name] for name, _ in columns}
    if not columns:
        raise RecordingError(f"{path}: holds no message with a number")
    found, data = _laid_together(list(topics.values()), rate)
    chosen = np.column_stack([data[name][:, (topics[name].ways or []).index(way)] for name, way in columns])
    names = tuple(".".join((name, *way)) for name, way in columns)
    units = tuple(topics[name].unit(way) for name, way in columns)
    return Signals(path, names, units, found, len(chosen), lambda: iter([chosen]), tuple(range(len(names))))


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Say which file it is of whatever the parsers of damaged bytes raise: struct's, lz4's, protobuf's errors, ..."""
    try:
        yield
    except (OSError, RecordingError):
        raise
    except Exception as fault:
        said = " ".join(str(fault).split())[:200] or type(fault).__name__
        raise RecordingError(f"{path}: not a readable MCAP file, it is damaged or cut short ({said})") from None


def _topics(reader: Any) -> list[str]:
    summary = reader.get_summary()
    if summary is not None and summary.channels:
        return sorted({channel.topic for channel in summary.channels.values()})
    return sorted({channel.topic for _, channel, _ in reader.iter_messages()})


def _column(path: Path, text: str, topics: Sequence[str]) -> tuple[str, Way]:
    """Return which topic and which of its numbers a channel is; of topics that begin alike the longest."""
    for topic in sorted(topics, key=len, reverse=True):
        way = way_of(text.removeprefix(topic)) if text.startswith(topic) else None
        if way is not None:
            return topic, way
    raise RecordingError(
        f"{path}: no channel {text!r}, must be TOPIC.FIELD or TOPIC.FIELD[NUMBER]; "
        f"topics are {', '.join(topics) or 'none'}"
    )


def _read(path: Path, reader: Any, columns: Sequence[tuple[str, Way]] | None) -> dict[str, _Topic]:
    """Read the numbers that are wanted, or all, of every topic."""
    topics: dict[str, _Topic] = {}
    for name, way in columns or ():
        ways = topics.setdefault(name, _Topic(path, name, [])).ways
        if ways is not None and way not in ways:
            ways.append(way)
    decoders: dict[int, Callable[[bytes], Any]] = {}
    for schema, channel, message in reader.iter_messages(None if columns is None else list(topics)):
        topic = topics.setdefault(channel.topic, _Topic(path, channel.topic, None))
        if channel.id not in decoders:
            topic.metadata = channel.metadata
            decoders[channel.id] = _decoder(path, channel, schema)
        topic.take(message.log_time, decoders[channel.id](message.data))
    return topics


def _decoder(path: Path, channel: Any, schema: Any) -> Callable[[bytes], Any]:
    decoder = decoder_of(channel.message_encoding, schema)
    if decoder is None:
        by = f" with a {schema.encoding} schema" if schema is not None and schema.encoding else ""
        raise RecordingError(
            f"{path}: {channel.topic} is encoded as {channel.message_encoding!r}{by}, must be {DECODED}"
        )
    return decoder


def _laid_together(topics: Sequence[_Topic], rate: float | None) -> tuple[float, dict[str, np.ndarray]]:
    """Return the rate, and by topic the numbers of the samples that all have, shape (samples, ways)."""
    first = min((min(topic.times) for topic in topics if topic.times), default=0)
    even = [topic.even(first, rate) for topic in topics]
    period, begin = even[0].period, max(each.start for each in even)
    skipped = [round((begin - each.start) / period) for each in even]
    frames = min(each.frames - skip for each, skip in zip(even, skipped, strict=True))
    for topic, each in zip(topics, even, strict=True):
        if not abs(each.period - period) <= min(STEADY, UNEVEN / max(frames, 1)) * period:
            raise RecordingError(
                f"{topic.path}: {topic.name} has {1 / each.period:.9g} samples/s, {topics[0].name} {1 / period:.9g}; "
                "columns must have one rate"
            )
    if frames < 1:
        raise RecordingError(
            f"{topics[0].path}: {', '.join(each.name for each in topics)} were logged one after the other"
        )
    parts = zip(topics, skipped, strict=True)
    return 1 / period, {topic.name: topic.values()[skip : skip + frames] for topic, skip in parts}


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if 0 < number < math.inf else None
