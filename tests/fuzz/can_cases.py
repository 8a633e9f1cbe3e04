"""Damaged CAN frames, to the inbox of the host and as lines of an slcan adapter."""

import math
import random
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rigkit.wire.layout import GarbledError, Layout
from stagectl.link.inbox import Inbox
from stagectl.link.slcan import SlcanBus
from stagectl.wire import messages, samples
from tests.fuzz.judge import Finding, is_accepted

BURST = {8: 8, 64: 16}
"""Bits within which a frame's checksum sees every change, by the bytes of the frame."""


class _Port:
    """A serial port that is never read."""

    timeout = write_timeout = 0.0
    in_waiting = 0


def cases(_: Path) -> Callable[[int], bool]:
    """Return what takes the damaged frame of a number, and says whether it passed for a sound one."""
    inboxes = {form: Inbox(form) for form in ("fd", "classic")}
    adapter = SlcanBus.__new__(SlcanBus)
    _as_new(adapter)

    def case(number: int) -> bool:
        chance = random.Random(number)
        layout = chance.choice(messages.LAYOUTS)
        sound = _sound(layout, chance)
        if number % 4 == 0:
            return _line(adapter, layout, sound, chance)
        data, is_burst = _damaged(sound, chance)
        accepted = is_accepted(lambda: _read(layout, data), lambda found: _check(layout, data, found), GarbledError)
        if accepted and is_burst and data != sound:
            raise Finding(f"{layout.name}: a burst within {BURST[layout.size]} bits passed for a frame")
        inbox = inboxes[chance.choice(("fd", "classic"))]
        counted = inbox.counts.garbled + inbox.counts.received + inbox.counts.late
        is_accepted(lambda: inbox.take(layout.identifier, data, 0.0), lambda _: None, ())
        if not isinstance(inbox.state, messages.State) or not isinstance(inbox.fault, messages.Fault):
            raise Finding(f"the stage is in state {inbox.state!r}, {inbox.fault!r}")
        if layout.sender == "host" and counted != inbox.counts.garbled + inbox.counts.received + inbox.counts.late:
            raise Finding(f"{layout.name} was counted as a frame of the stage")
        return accepted

    return case


def _sound(layout: Layout, chance: random.Random) -> bytes:
    values: list[int] = []
    for field in layout.fields:
        if field.choices is not None:
            values.append(int(chance.choice(list(field.choices))))
        elif field.kind == "h":
            values.append(chance.randrange(-32_767, 32_768))
        else:
            values.append(chance.getrandbits(field.bits))
    return layout.pack(chance.getrandbits(16), *values)


def _damaged(sound: bytes, chance: random.Random) -> tuple[bytes, bool]:
    """Change a frame; say whether by bits alone that lie close together in the order in which they are sent."""
    data = bytearray(sound)
    match chance.randrange(4):
        case 0:
            length = BURST[len(sound)]
            burst = (chance.getrandbits(length) | 1) << chance.randrange(8 * len(sound) - length + 1)
            return (int.from_bytes(sound) ^ burst).to_bytes(len(sound)), True
        case 1:
            return bytes(data[: chance.randrange(len(data))]), False
        case 2:
            return bytes(data) + chance.randbytes(chance.choice((1, 4, 56))), False
        case _:
            for _ in range(chance.randrange(1, 6)):
                data[chance.randrange(len(data))] = chance.randrange(256)
            return bytes(data), False


def _read(layout: Layout, data: bytes) -> Any:
    if layout.fields[0].kind == "h":
        return samples.decode(layout, data)
    return layout.unpack(data)


def _check(layout: Layout, data: bytes, found: Any) -> None:
    counter, values = found
    assert len(data) == layout.size, f"{len(data)} bytes"
    assert 0 <= counter < layout.modulus, f"counter {counter}"
    if isinstance(values, np.ndarray):
        assert (np.abs(values[~np.isnan(values)]) <= samples.largest(layout) * (1 + 1e-12)).all(), "beyond its range"
        counts = np.frombuffer(data, "<i2", values.size)
        assert (np.isnan(values.ravel()) == (counts == samples.INVALID)).all(), "NaN"
        return
    for field, value in zip(layout.fields, values, strict=True):
        assert math.isfinite(value), f"{field.name} is {value}"
        assert field.choices is None or value in list(field.choices), f"{field.name} is {value}"


def _as_new(adapter: SlcanBus) -> None:
    """Make an adapter without a port."""
    adapter.garbled, adapter._rest, adapter._is_shutdown = 0, b"", True  # noqa: SLF001
    adapter._frames = deque()  # noqa: SLF001
    adapter.serialPortOrig = _Port()


def _line(adapter: SlcanBus, layout: Layout, sound: bytes, chance: random.Random) -> bool:
    """Damage the text of a frame; what is taken must have the length that its line says, and the rest be counted."""
    kind, code = ("t", "8") if len(sound) == 8 else ("b", "F")
    line = bytearray(f"{kind}{layout.identifier:03X}{code}{sound.hex().upper()}\r".encode())
    for _ in range(chance.randrange(1, 5)):
        line[chance.randrange(len(line))] = chance.choice(b"\r\atTdDbBzZ0189AFGxr\x00\xff ")
    is_accepted(lambda: adapter._take(bytes(line)), lambda _: None, ())  # noqa: SLF001
    frames = len(adapter._frames)  # noqa: SLF001
    while adapter._frames:  # noqa: SLF001
        message = adapter._frames.popleft()  # noqa: SLF001
        if len(message.data) not in (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64):
            raise Finding(f"a message of {len(message.data)} bytes")
        if not 0 <= message.arbitration_id < (1 << 29 if message.is_extended_id else 1 << 11):
            raise Finding(f"an identifier of {message.arbitration_id:#x}")
    if len(adapter._rest) > 400:  # noqa: SLF001
        raise Finding("the rest of a line grows")
    return frames > 0
