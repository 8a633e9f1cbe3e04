"""One emission as a recording: its channels, and the folder for those that nothing may be learned from."""

from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit import atomic
from vibractl.capture import Capture, Discarded
from vibractl.config import RigConfig

DISCARDED = "discarded"
"""Folder beside the recordings."""
EVIDENCE = ("delay", "residual", "quality", "input_xruns", "output_xruns", "late")
"""What is kept of each emission beside its samples."""


def recording_of(capture: Capture, config: RigConfig) -> Recording:
    """Return one emission as it is written: its signals, and the evidence for their alignment."""
    drives, responses = channel_names(config)
    hydrophones = hydrophone_names(config)
    names = (*drives, *responses, *hydrophones, "loopback")
    units = ("V",) * len(drives) + ("m/s^2",) * len(responses) + ("Pa",) * len(hydrophones) + ("1",)
    data = np.column_stack((capture.emitted, capture.response, capture.far_field, capture.loopback))
    about = {name: repr(getattr(capture, name)) for name in EVIDENCE}
    return Recording(names, units, config.audio.rate, data, {"rig": config.rig.name, **about})


def split(record: Recording, config: RigConfig) -> tuple[np.ndarray, np.ndarray]:
    """Return drives and responses of a shot's recording, (samples, drives) V and (samples, responses) m/s^2.

    Raises
    ------
    RecordingError : a channel is missing.
    """
    drives, responses = channel_names(config)
    return record.select(drives).data, record.select(responses).data


def far_field_of(record: Recording, config: RigConfig) -> np.ndarray:
    """Return the far field of a shot's recording, (samples, hydrophones), Pa; no columns where there is none.

    Raises
    ------
    RecordingError : a channel is missing.
    """
    names = hydrophone_names(config)
    return record.select(names).data if names else np.zeros((len(record.data), 0))


def channel_names(config: RigConfig) -> tuple[list[str], list[str]]:
    """Return the names that a shot's recording has for drives and for responses."""
    return (
        [f"drive_{n + 1}" for n in range(len(config.audio.drive_channels))],
        [f"response_{n + 1}" for n in range(len(config.audio.response_channels))],
    )


def hydrophone_names(config: RigConfig) -> list[str]:
    """Return the names that a shot's recording has for the far field."""
    return [f"far_field_{n + 1}" for n in range(len(config.audio.far_field_channels))]


def keep_discarded(place: Path, name: str, discarded: Discarded, config: RigConfig) -> Path:
    """Keep a recording that nothing may be learned from.

    Parameters
    ----------
    place : Path
        Folder; made if absent.
    name : str
        Begins the file's name.
    discarded : Discarded
    config : RigConfig

    Returns
    -------
    Path
        A recording; or an `.npy` file of response, far field and loopback alone where they are not finite.
    """
    path = _next_in(place, f"{name}-{discarded.attempt}", ".wav")
    heard = np.column_stack((discarded.capture.response, discarded.capture.far_field, discarded.capture.loopback))
    if np.isfinite(heard).all():
        recording.write(path, recording_of(discarded.capture, config))
    else:
        path = path.with_suffix(".npy")
        with atomic.replacing(path, heard.nbytes) as temporary:
            np.save(temporary, heard)
    return path


def set_aside(place: Path, recorded: Path) -> Path:
    """Move a recording to the folder (made if absent) of those that nothing may be learned from; return where it is."""
    return recorded.rename(_next_in(place, recorded.stem, recorded.suffix))


def _next_in(place: Path, name: str, suffix: str) -> Path:
    """Return a path in a folder, made if absent, that ends in how many things are there."""
    place.mkdir(parents=True, exist_ok=True)
    return place / f"{name}-{len(list(place.iterdir())):03d}{suffix}"
