"""One emission as a recording: its channels, and the folder for those that nothing may be learned from."""

from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from vibractl.capture import Capture, Discarded
from vibractl.config import RigConfig

DISCARDED = "discarded"
"""Folder beside the recordings."""
EVIDENCE = ("delay", "residual", "quality", "input_xruns", "output_xruns", "late")
"""What is kept of each emission beside its samples."""


def recording_of(capture: Capture, config: RigConfig) -> Recording:
    """Return one emission as it is written: drives, responses, loopback, and the evidence for its alignment."""
    drives, responses = channel_names(config)
    names = (*drives, *responses, "loopback")
    units = ("V",) * len(drives) + ("m/s^2",) * len(responses) + ("1",)
    data = np.column_stack((capture.emitted, capture.response, capture.loopback))
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


def channel_names(config: RigConfig) -> tuple[list[str], list[str]]:
    """Return the names that a shot's recording has for drives and for responses."""
    return (
        [f"drive_{n + 1}" for n in range(len(config.audio.drive_channels))],
        [f"response_{n + 1}" for n in range(len(config.audio.response_channels))],
    )


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
        A recording; or an `.npy` file of the response alone where that is not finite.
    """
    place.mkdir(parents=True, exist_ok=True)
    path = place / f"{name}-{discarded.attempt}-{len(list(place.iterdir())):03d}.wav"
    if np.isfinite(discarded.capture.response).all():
        recording.write(path, recording_of(discarded.capture, config))
    else:
        path = path.with_suffix(".npy")
        np.save(path, discarded.capture.response)
    return path
