"""How long frames keep the bus busy, at worst."""

from rigkit.wire.layout import Layout
from stagectl.wire import messages

_CLASSIC_ENDS = 47
"""Bits of a classic frame with 11 bits of identifier beside its data: 34 that may be stuffed, 10 not, 3 of silence."""
_STUFFED = 34
_FD_HEAD, _FD_TAIL = 17, 13
"""Bits at the slow rate: from the start to BRS; from the CRC's delimiter through acknowledge and end to the silence."""
_FD_CONTROL, _FD_CHECK = 5, 4 + 21 + 7
"""Bits at the fast rate beside the data: ESI and length; stuff count, CRC-21 and their fixed stuff bits."""
_RUN = 4
"""Bits that a stuff bit follows at worst."""


def frame_time(layout: Layout, bitrate: int, data_bitrate: int) -> float:
    """Return for how long a frame keeps the bus at most, s.

    Parameters
    ----------
    layout : Layout
    bitrate, data_bitrate : int, bit/s
        Of a classic frame and of an FD frame's arbitration; of an FD frame's data.

    Source
    ------
    ISO 11898-1:2015, frame formats and bit stuffing.

    Examples
    --------
    >>> round(1e6 * frame_time(messages.SLOW_POSITION, 1_000_000, 5_000_000))
    135
    >>> round(1e6 * frame_time(messages.POSITION, 1_000_000, 5_000_000))
    170
    """
    data = 8 * layout.size
    if not layout.is_fd:
        return (_CLASSIC_ENDS + data + (_STUFFED + data - 1) // _RUN) / bitrate
    slow = _FD_HEAD + (_FD_HEAD - 1) // _RUN + _FD_TAIL
    fast = _FD_CONTROL + data + (_FD_CONTROL + data) // _RUN + _FD_CHECK
    return slow / bitrate + fast / data_bitrate


def least_load(form: str, bitrate: int, data_bitrate: int) -> float:
    """Return the part of the time for which references, positions and heartbeats keep the bus busy at most, 1.

    Parameters
    ----------
    form : "fd" or "classic"
    bitrate, data_bitrate : int, bit/s
    """
    streams = {
        "fd": (messages.REFERENCE, messages.POSITION),
        "classic": (messages.SLOW_REFERENCE, messages.SLOW_POSITION),
    }[form]
    always = (*streams, messages.HOST_HEARTBEAT, messages.STAGE_HEARTBEAT)
    return sum(frame_time(layout, bitrate, data_bitrate) / layout.period for layout in always)


def excited_load(bitrate: int, data_bitrate: int) -> float:
    """Return the part of the time for which an excited axis keeps a CAN FD bus busy at most, 1.

    Every block's extension and voltage come as well.

    Parameters
    ----------
    bitrate, data_bitrate : int, bit/s
    """
    more = (messages.EXTENSION, messages.VOLTAGE)
    busy = sum(frame_time(layout, bitrate, data_bitrate) for layout in more) / messages.PERIOD
    return least_load("fd", bitrate, data_bitrate) + busy


def laser_load(form: str, bitrate: int, data_bitrate: int) -> float:
    """Return the part of the time for which the bus is busy at most while the stage shows what its lasers see, 1.

    Parameters
    ----------
    form : "fd" or "classic"
    bitrate, data_bitrate : int, bit/s
    """
    layout = messages.ABSOLUTE if form == "fd" else messages.SLOW_ABSOLUTE
    return least_load(form, bitrate, data_bitrate) + frame_time(layout, bitrate, data_bitrate) / messages.PERIOD
