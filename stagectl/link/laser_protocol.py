"""The laser sensor's lines: what it is asked, and what it says, in the form of Keyence's LK-G controllers.

Lines end with CR.  A request for the value of OUT1 is `M1`, its answer `M1,+00.1234`; a sensor that sends by itself
says `TG,1,+00.1234` for each value; a request it does not take is answered `ER,M1,01`.  A value has eight characters;
`+FFFFFFF` and `-FFFFFFF` are out of range, `XXXXXXXX` is no value yet.

Source
------
Keyence, LK-G Series User's Manual (LK-G-M-NO5-E), pages 5-5 (commands, error codes), 5-6 (measurement value) and 5-24
(output by itself).
"""

import math
import re
from dataclasses import dataclass

END = b"\r"
VALUE_LENGTH = 8
LONGEST_LINE = 64
"""Characters; more without an end is garbage."""

ERRORS = {
    0: "command error",
    1: "status error",
    20: "command length error",
    21: "parameter count error",
    22: "invalid parameter error",
    88: "timeout error",
    99: "other error",
}

_VALUE = re.compile(rb"[+-](?=[\d.]{7}$)\d+\.?\d*")
_NONE = (b"+FFFFFFF", b"-FFFFFFF", b"XXXXXXXX")


class LaserError(ValueError):
    """A line that the sensor does not say, or by which it refuses what was asked."""


@dataclass(frozen=True)
class Reading:
    """A value of the sensor.

    Parameters
    ----------
    output : int, 1 or 2
    displayed : float, in what its display shows, such as mm
        NaN where the target is out of range or there is no value yet.
    """

    output: int
    displayed: float


def request(output: int) -> bytes:
    """Return the request for the value of an output, 1 or 2."""
    return b"M%d%s" % (output, END)


def reading(line: bytes) -> Reading:
    """Read a line, without its end.

    Raises
    ------
    LaserError : it is no value.

    Examples
    --------
    >>> reading(b"TG,1,-00.0120")
    Reading(output=1, displayed=-0.012)
    >>> reading(b"M1,+FFFFFFF")
    Reading(output=1, displayed=nan)
    """
    head, _, value = line.rpartition(b",")
    if line[:3].upper() == b"ER,":
        code = int(value) if value.isdigit() else 99
        raise LaserError(f"the laser sensor refuses {head[3:].decode('latin-1')!r}: {ERRORS.get(code, code)}")
    if head.upper() not in (b"M1", b"M2", b"TG,1", b"TG,2") or len(value) != VALUE_LENGTH:
        raise LaserError(f"the laser sensor says {line[:LONGEST_LINE]!r}, must be as M1,+00.1234 or TG,1,+00.1234")
    output = int(head[-1:])
    if value.upper() in _NONE:
        return Reading(output, math.nan)
    if not _VALUE.fullmatch(value):
        raise LaserError(f"the laser sensor says {line!r}, its value must be a sign and seven digits and a point")
    return Reading(output, float(value))


def said(displayed: float) -> bytes:
    """Return the eight characters of a value, to four decimals; out of range and NaN as the sensor says them."""
    if math.isnan(displayed):
        return b"XXXXXXXX"
    text = b"%+08.4f" % displayed
    return text if len(text) == VALUE_LENGTH else b"%cFFFFFFF" % (b"+" if displayed > 0 else b"-")


class Lines:
    """Puts lines together from what comes in pieces, counts them, and drops what grows without an end."""

    def __init__(self) -> None:
        self.complete = 0
        self._rest = b""

    def forget(self) -> None:
        """Drop the line that is not complete: what follows has another beginning."""
        self._rest = b""

    def take(self, data: bytes) -> list[bytes]:
        """Return the lines that are complete now; empty ones, and LF behind CR, are left out."""
        *lines, self._rest = (self._rest + data).replace(b"\n", b"").split(END)
        if len(self._rest) > LONGEST_LINE:
            self._rest = b""
        self.complete += len(lines)
        return [line for line in lines if line]
