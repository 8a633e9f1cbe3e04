"""Every frame between host and stage: identifiers, fields, states, faults and commands."""

from enum import IntEnum

from rigkit.wire.layout import LONG, NEVER, SHORT, Field, Layout

RATE = 10_000
"""Samples/s of the stage's loops."""
BLOCK = 10
"""Samples of an axis in a long frame: one frame, and one count of its counter, a millisecond."""
AXES = ("x", "y", "z")
PERIOD = BLOCK / RATE
"""s from block to block."""

HEARTBEAT = 0.005
"""s between heartbeats."""
SILENCE = 0.020
"""s without a heartbeat of the host after which the stage goes to mid-travel."""
HOLD = 0.030
"""s beyond `SILENCE` for which references, and the stage's heartbeat, may stay away: a tty's stalls."""
LONGEST_AHEAD = 0.2
"""s of an excitation that wait at the stage before it is played, at most."""

LONG_DATA, SHORT_DATA = 58, 4
"""Bytes of a parameter set in a frame."""


class State(IntEnum):
    """What the stage does."""

    HOLDING = 0
    """At mid-travel, closed loop, deaf to references."""
    FOLLOWING = 1
    RAMPING = 2
    """On its way to mid-travel, after STOP or a fault."""
    FAULT = 3
    """At mid-travel until a person acknowledges."""
    EXCITED = 4
    """One axis away from rest as the host says, its outer loop open, the others at their rest voltage."""


class Drive(IntEnum):
    """What of an axis is excited."""

    VOLTAGE = 1
    EXTENSION = 2
    """The reference of its inner loop."""


class HostState(IntEnum):
    """What the host does."""

    IDLE = 0
    STREAMING = 1
    FAULT = 2


class Fault(IntEnum):
    """Why the stage does not follow.  The first one is kept until it is acknowledged."""

    NONE = 0
    HOST_SILENT = 1
    HOST_FAULT = 2
    REFERENCE_SILENT = 3
    REFERENCE_GARBLED = 4
    SENSOR_STUCK = 5
    SENSOR_INVALID = 6
    CONTROLLER = 7
    """The stage's own loops have latched, or failed."""
    OVERRUN = 8
    """The processor cannot keep its own time."""
    TRAVEL = 9
    """The plate has left its travel while it was excited."""
    LASER_STALE = 10
    """The newest valid reading of a laser is too old."""
    LASER_STUCK = 11
    LASER_IMPOSSIBLE = 12
    """A laser is out of range, jumps or gives no number."""


class Command(IntEnum):
    """What the host may ask for; every command is answered by a reply with its token."""

    START = 1
    STOP = 2
    ACKNOWLEDGE = 3
    BEGIN = 4
    """A parameter set of `argument` bytes follows."""
    CHECK = 5
    """How many chunks have come in order?"""
    READ = 6
    """Send the set back, `WINDOW` chunks from chunk `argument` on."""
    COMMIT = 7
    """Use the set, whose CRC-32 is `argument`, from the next block on."""
    EXCITE = 8
    """Let an axis, counted from 0, be excited: 256 times a `Drive`, and the axis, is `argument`."""


class Result(IntEnum):
    """What became of a command."""

    DONE = 0
    WRONG_STATE = 1
    WRONG_SIZE = 2
    INCOMPLETE = 3
    WRONG_CHECKSUM = 4
    REFUSED = 5
    """The set is whole, but the stage's loops refuse it."""


WINDOW = 16
"""Chunks of a parameter set that may be under way."""


def _samples(scale: float, unit: str, count: int) -> tuple[Field, ...]:
    return tuple(Field(f"{axis}_{n}", "h", scale, unit) for n in range(count) for axis in AXES)


def _chunk(size: int) -> tuple[Field, ...]:
    return (Field("number", "H"), *(Field(f"data_{n}", "B") for n in range(size)))


HOST_HEARTBEAT = Layout(
    "HostHeartbeat",
    0x010,
    "host",
    SHORT,
    (Field("state", "B", choices=HostState), Field("spare", "B"), Field("time", "I", unit="ms")),
    HEARTBEAT,
    "the host is there; time since its link was opened",
)
STAGE_HEARTBEAT = Layout(
    "StageHeartbeat",
    0x011,
    "stage",
    SHORT,
    (Field("state", "B", choices=State), Field("fault", "B", choices=Fault), Field("time", "I", unit="ms")),
    HEARTBEAT,
    "the stage is there, and what it does; time since it was switched on",
)
COMMAND = Layout(
    "Command",
    0x020,
    "host",
    SHORT,
    (Field("command", "B", choices=Command), Field("token", "B"), Field("argument", "I")),
    NEVER,
    "asks for something",
)
REPLY = Layout(
    "Reply",
    0x021,
    "stage",
    SHORT,
    (Field("token", "B"), Field("result", "B", choices=Result), Field("argument", "I")),
    NEVER,
    "answers the command with this token",
)
REFERENCE = Layout(
    "Reference", 0x100, "host", LONG, _samples(0.01, "um", BLOCK), PERIOD, "where the stage is to be, from mid-travel"
)
POSITION = Layout(
    "Position", 0x101, "stage", LONG, _samples(0.01, "um", BLOCK), PERIOD, "where it is, by the capacitive sensors"
)
EXTENSION = Layout(
    "Extension", 0x102, "stage", LONG, _samples(0.005, "um", BLOCK), NEVER, "extension of the piezos, by strain gauge"
)
VOLTAGE = Layout("Voltage", 0x103, "stage", LONG, _samples(0.05, "V", BLOCK), NEVER, "voltage on the piezos")
STATUS = Layout(
    "Status",
    0x110,
    "stage",
    LONG,
    (
        Field("time", "Q", unit="ns"),
        Field("block", "Q"),
        Field("parameters", "I"),
        Field("lost", "I"),
        Field("late", "I"),
        Field("garbled", "I"),
        Field("underruns", "I"),
        Field("reference", "H"),
        Field("waiting", "H"),
        Field("silence", "H", 0.1, "ms"),
        Field("state", "B", choices=State),
        Field("fault", "B", choices=Fault),
    ),
    0.1,
    "64-bit time and block number of the newest block, CRC-32 of the parameters in use, what became of the references",
)
VOLTAGE_DRIVE = Layout(
    "VoltageDrive", 0x104, "host", LONG, _samples(0.05, "V", BLOCK), NEVER, "excitation: voltage of an axis, from rest"
)
EXTENSION_DRIVE = Layout(
    "ExtensionDrive",
    0x105,
    "host",
    LONG,
    _samples(0.005, "um", BLOCK),
    NEVER,
    "excitation: reference of an axis' inner loop, from rest",
)
ABSOLUTE = Layout(
    "Absolute", 0x106, "stage", LONG, _samples(0.05, "um", BLOCK), NEVER, "plate and robot together, by laser"
)
LASER_STATUS = Layout(
    "LaserStatus",
    0x111,
    "stage",
    SHORT,
    (Field("age", "H", 0.1, "ms"), Field("held", "H"), Field("axis", "B"), Field("spare", "B")),
    NEVER,
    "greatest age of a reading since the last such frame, invalid readings held off, axis of the fault (1 to 3)",
)
DRIVES = {Drive.VOLTAGE: VOLTAGE_DRIVE, Drive.EXTENSION: EXTENSION_DRIVE}
SLOW_REFERENCE = Layout(
    "SlowReference", 0x120, "host", SHORT, _samples(0.01, "um", 1), PERIOD, "classic CAN: the block's last reference"
)
SLOW_POSITION = Layout(
    "SlowPosition", 0x121, "stage", SHORT, _samples(0.01, "um", 1), PERIOD, "classic CAN: the block's last position"
)
SLOW_EXTENSION = Layout(
    "SlowExtension", 0x122, "stage", SHORT, _samples(0.005, "um", 1), NEVER, "classic CAN: the block's last extension"
)
SLOW_VOLTAGE = Layout(
    "SlowVoltage", 0x123, "stage", SHORT, _samples(0.05, "V", 1), NEVER, "classic CAN: the block's last voltage"
)
SLOW_ABSOLUTE = Layout(
    "SlowAbsolute", 0x124, "stage", SHORT, _samples(0.05, "um", 1), NEVER, "classic CAN: the block's last laser value"
)
WRITE_CHUNK = Layout("WriteChunk", 0x200, "host", LONG, _chunk(LONG_DATA), NEVER, "a piece of a parameter set")
READ_CHUNK = Layout("ReadChunk", 0x201, "stage", LONG, _chunk(LONG_DATA), NEVER, "the same piece, sent back")
SLOW_WRITE_CHUNK = Layout("SlowWriteChunk", 0x210, "host", SHORT, _chunk(SHORT_DATA), NEVER, "classic CAN: a piece")
SLOW_READ_CHUNK = Layout("SlowReadChunk", 0x211, "stage", SHORT, _chunk(SHORT_DATA), NEVER, "classic CAN: sent back")

LAYOUTS = (
    HOST_HEARTBEAT,
    STAGE_HEARTBEAT,
    COMMAND,
    REPLY,
    REFERENCE,
    POSITION,
    EXTENSION,
    VOLTAGE,
    VOLTAGE_DRIVE,
    EXTENSION_DRIVE,
    ABSOLUTE,
    STATUS,
    LASER_STATUS,
    SLOW_REFERENCE,
    SLOW_POSITION,
    SLOW_EXTENSION,
    SLOW_VOLTAGE,
    SLOW_ABSOLUTE,
    WRITE_CHUNK,
    READ_CHUNK,
    SLOW_WRITE_CHUNK,
    SLOW_READ_CHUNK,
)
BY_IDENTIFIER = {layout.identifier: layout for layout in LAYOUTS}
