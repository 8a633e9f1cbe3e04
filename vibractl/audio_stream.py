"""Opening the audio stream that a rig file names, or saying clearly why that cannot be."""

import sys
from collections.abc import Callable
from typing import Any

from rigkit.named_code import named_class
from vibractl.config import Audio, RigConfig


class AudioError(OSError):
    """The audio interface cannot do what is asked of it, or has stopped doing it."""


def open_stream(config: RigConfig, callback: Callable[..., None]) -> Any:
    """Open, but do not start, one full-duplex stream with as many channels as the largest number in the rig file.

    Parameters
    ----------
    config : RigConfig
    callback : callable(indata, outdata, frames, time, status)
        With float32 arrays, shape (frames, channels), full scale.

    Returns
    -------
    object with sounddevice.Stream's methods
        One that has no clock of its own has `advance(frames)` beside them.

    Raises
    ------
    AudioError : no such class, device or channel, or the device refuses the rate; it says what there is.
    """
    audio = config.audio
    module, constructor = _constructor(config)
    inputs, outputs = channels(audio)
    try:
        if audio.device:
            _refuse_missing_channels(module, audio, inputs, outputs)
        return constructor(
            samplerate=audio.rate,
            blocksize=audio.blocksize,
            device=audio.device or None,
            channels=(inputs, outputs),
            dtype="float32",
            callback=callback,
            clip_off=True,
            dither_off=True,
        )
    except AudioError:
        raise
    except Exception as fault:
        name = repr(audio.device) if audio.device else "the default"
        raise AudioError(
            f"{audio.stream} cannot open audio.device {name} at {audio.rate} samples/s with {inputs} inputs and "
            f"{outputs} outputs: {fault}{_there_is(module)}"
        ) from fault


def channels(audio: Audio) -> tuple[int, int]:
    """Return how many input and output channels the rig file needs, loopback and heartbeat included."""
    loopback = audio.alignment == "loopback"
    inputs = max(*audio.response_channels, *audio.far_field_channels, audio.loopback_input if loopback else 1)
    outputs = max(*audio.drive_channels, audio.loopback_output if loopback else 1, audio.heartbeat_output)
    return inputs, outputs


def _constructor(config: RigConfig) -> tuple[Any, Any]:
    """Return the module and the constructor; a class that wants to see the whole rig file first has `from_config`."""
    found = class_of(config.audio)
    try:
        return sys.modules[found.__module__], found.from_config(config) if hasattr(found, "from_config") else found
    except ValueError as fault:
        raise AudioError(str(fault)) from fault


def class_of(audio: Audio) -> Any:
    """Return the class of stream that a rig file names; AudioError where there is none."""
    try:
        return named_class(audio.stream, "the class of an audio stream, as sounddevice:Stream is", _is_stream)
    except ValueError as fault:
        hint = "; on Debian: apt-get install libportaudio2" if "PortAudio" in str(fault) else ""
        raise AudioError(f"audio.stream, {fault}{hint}") from fault


def _is_stream(found: type) -> bool:
    return all(callable(getattr(found, each, None)) for each in ("start", "stop", "abort", "close"))


def _refuse_missing_channels(module: Any, audio: Audio, inputs: int, outputs: int) -> None:
    query = getattr(module, "query_devices", None)
    if query is None:
        return
    for kind, needed in (("input", inputs), ("output", outputs)):
        there = query(audio.device, kind)[f"max_{kind}_channels"]
        if there < needed:
            raise AudioError(
                f"audio.device {audio.device!r} has {there} {kind} channels, the rig file needs {needed}"
                f"{_there_is(module)}"
            )


def _there_is(module: Any) -> str:
    query = getattr(module, "query_devices", None)
    if query is None:
        return ""
    names = [
        f"{device['name']!r} ({device['max_input_channels']} in, {device['max_output_channels']} out, "
        f"{device['default_samplerate']:g} samples/s)"
        for device in query()
    ]
    return f"; there are the devices {', '.join(names)}" if names else "; there are no audio devices at all"
