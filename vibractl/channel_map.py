"""Which channel of the card is whose: no two signals share one."""

from typing import Any

MOST = 64
"""Channels each way; the loopback's keys have the same limit."""


def collision(audio: Any) -> str:
    """Say which two keys of a rig file's `[audio]` want the same channel, or which channel cannot be; nothing if none.

    Parameters
    ----------
    audio : Audio

    Returns
    -------
    str

    Examples
    --------
    >>> from vibractl.config import Audio
    >>> collision(Audio(drive_channels=(1, 2, 3, 4)))
    'audio.drive_channels [1, 2, 3, 4] and audio.loopback_output 3 share output 3, must be different'
    """
    cable = audio.alignment == "loopback"
    outputs = ["drive_channels", *["loopback_output"] * cable, *["heartbeat_output"] * bool(audio.heartbeat_output)]
    inputs = ["response_channels", "far_field_channels", *["loopback_input"] * cable]
    return _shared(audio, "output", outputs) or _shared(audio, "input", inputs)


def _shared(audio: Any, way: str, keys: list[str]) -> str:
    owner: dict[int, str] = {}
    for key in keys:
        value = getattr(audio, key)
        for channel in value if isinstance(value, tuple) else (value,):
            if not 1 <= channel <= MOST:
                return f"audio.{key} has {channel}, must be 1 to {MOST}"
            if channel in owner:
                others = (f"audio.{name} {_text(audio, name)}" for name in dict.fromkeys((owner[channel], key)))
                return f"{' and '.join(others)} share {way} {channel}, must be different"
            owner[channel] = key
    return ""


def _text(audio: Any, key: str) -> str:
    value = getattr(audio, key)
    return str(list(value)) if isinstance(value, tuple) else str(value)
