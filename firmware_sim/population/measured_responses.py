"""Impulse responses that others measured, in ../shared/data beside the checkout: two sources, two sensors."""

from pathlib import Path

import numpy as np
import scipy.io
import soundfile

DATA = Path(__file__).parents[3] / "shared" / "data"
RATE = 44_100
"""samples/s, of all of them."""
HEADS = tuple(range(30, 151, 5))
"""Degrees off the front at which a loudspeaker's sound at a head was measured."""
ROOM_START, ROOM_END, ROOM_FADE = 1_580, 19_220, 4_410
"""Samples: sound has travelled, 0.4 s later the rest is left out, after a fade of 0.1 s."""


def head(left: int, right: int, folder: Path = DATA) -> np.ndarray:
    """Return what the ears of a head hear of two loudspeakers, shape (taps, ears, loudspeakers), 1.

    Parameters
    ----------
    left, right : int, degrees
        How far each loudspeaker is off the front, on its own side.
    folder : Path

    Raises
    ------
    ValueError : the files are not there.
    """
    sides = [soundfile.read(present(folder, f"kemar/H0e{angle:03d}a.wav"))[0] for angle in (left, right)]
    return np.stack([sides[0][:, ::-1], sides[1]], axis=-1)  # measured on the right; the left ear is channel 1


def room(folder: Path = DATA) -> np.ndarray:
    """Return what two microphones hear in a room, shape (taps, microphones, sources), 1; source 2 mirrors source 1.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    ValueError : the file is not there.
    """
    both = scipy.io.loadmat(present(folder, "room/EstereoRIS1_time.mat"))["EstereoRIS1_time"]
    taps = both[ROOM_START:ROOM_END].astype(float)
    taps[-ROOM_FADE:] *= (0.5 + 0.5 * np.cos(np.pi * np.arange(ROOM_FADE) / ROOM_FADE))[:, None]
    return np.stack([taps, taps[:, ::-1]], axis=-1)


def present(folder: Path, path: str) -> Path:
    """Return a file of the measured data.

    Raises
    ------
    ValueError : it is not there.
    """
    if not (folder / path).is_file():
        raise ValueError(f"family measured wants {folder / path}, which is not there: no other family reads a file")
    return folder / path
