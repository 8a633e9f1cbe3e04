"""Whether a learned drive belongs to a run: same rig, same wiring, same reference, same lines."""

import hashlib
import json

import numpy as np

from vibractl.config import RigConfig
from vibractl.library.entry import Entry
from vibractl.reference import Reference

STEPS = 2**20
"""Of the peak, to which a reference is rounded before it is hashed: machines differ in a sine's last bits."""


def reference_hash(reference: Reference, rate: float) -> str:
    """Return a hash of a reference's samples, hexadecimal; its text does not count."""
    peak = float(np.abs(reference.signal).max())
    told = hashlib.sha256(f"{rate:g} {reference.signal.shape} {peak:.6g}".encode())
    told.update(np.round(reference.signal / peak * STEPS).astype("<i4").tobytes())
    return told.hexdigest()


def wiring(config: RigConfig) -> str:
    """Return in words which channels are driven and heard, and on which lines they are learned together."""
    audio, learning = config.audio, config.learning
    channels = {"drive": audio.drive_channels, "response": audio.response_channels}
    if learning.sensors == "far-field":
        channels["far_field"] = audio.far_field_channels
    learned = {key: getattr(learning, key) for key in ("side", "structure", "sensors", "band", "decimation")}
    return json.dumps({**channels, **learned})


def misfit(entry: Entry, config: RigConfig, reference: Reference) -> str:
    """Say why an entry does not belong to a run; nothing when it does.

    Parameters
    ----------
    entry : Entry
    config : RigConfig
    reference : Reference

    Returns
    -------
    str
    """
    about = entry.about
    if about["rig"] != config.rig.name:
        return f"of rig {about['rig']!r}, this rig is {config.rig.name!r}"
    if about["wiring"] != wiring(config):
        return f"of channels and bins {about['wiring']}, this run has {wiring(config)}"
    if about["reference_hash"] != reference_hash(reference, config.audio.rate):
        told = about["reference_text"]
        same = " (of another amplitude, taper or rate)" if told == reference.text else ""
        return f"of reference {told}, this run's is {reference.text}{same}"
    return ""
