"""Sounds for other software: parts of full scale in as many bits as it wants."""

from pathlib import Path

import numpy as np
import soundfile

from rigkit.atomic import replacing

BITS = {16: "PCM_16", 24: "PCM_24", 32: "FLOAT", 64: "DOUBLE"}
"""How samples are written; a drive comes back bit for bit from 64 alone, for V are not parts of full scale."""


def write_sound(path: Path, data: np.ndarray, rate: int, bits: int) -> None:
    """Write a WAV file, whole or not at all.

    Parameters
    ----------
    path : Path, ending in .wav
    data : array, shape (samples, channels), within -1 to 1
    rate : int, samples/s
    bits : int, one of `BITS`

    Raises
    ------
    ValueError : another suffix, or a sample beyond full scale.
    OSError : it cannot be written.
    """
    if path.suffix.lower() != ".wav":
        raise ValueError(f"{path}: suffix is {path.suffix!r}, must be .wav")
    loudest = float(np.abs(data).max())
    if not loudest <= 1.0:
        raise ValueError(f"{path}: a sample is {loudest:.4g} of full scale, must be <= 1")
    kind = "WAV" if data.nbytes < 2**31 else "RF64"
    with replacing(path, data.nbytes * bits // 64) as partial, partial.open("wb") as file:
        soundfile.write(file, data, rate, BITS[bits], format=kind)


def refuse_bits(bits: int) -> None:
    """Refuse samples of a size that is none of `BITS`, by ValueError."""
    if bits not in BITS:
        raise ValueError(f"--bits is {bits}, must be {', '.join(map(str, BITS))}")
