"""Measurements made by others, in ../shared/data beside the checkout, and two-channel plants made from them."""

from pathlib import Path

import numpy as np
import pytest
import soundfile

from firmware_sim.population.measured_responses import head, room

DATA = Path(__file__).parents[2] / "shared" / "data"
RATE = 44_100
MEASURED_PAIRS = ("head-30-110", "head-90", "room")
"""Two loudspeakers, one on each side, 30 and 110 degrees off; both 90 degrees off; two microphones in a room."""


def shared(path: str) -> Path:
    """Return a file under ../shared/data, or skip the test that wants it, with the reason."""
    if not (DATA / path).exists():
        pytest.skip(f"{DATA / path} is not here")
    return DATA / path


def measured_pair(name: str, folder: Path) -> list[Path]:
    """Write one of `MEASURED_PAIRS` as two WAV files into a folder: both channels, for each of the two sources.

    They are scaled so that, over 40 to 90 Hz, the sources must move a quarter more (rms) than both channels are to:
    overtones above 100 Hz are then as loud as on the simulated vibrator itself.
    """
    taps = _taps(name)
    frequency = np.arange(40, 91)
    response = np.fft.rfft(taps, RATE, axis=0)[frequency]  # 1 Hz apart
    needed = np.linalg.solve(response, np.ones((len(frequency), 2, 1)))
    taps = taps * np.sqrt(np.mean(np.abs(needed) ** 2)) / 1.25
    files = [folder / f"{name}-{source + 1}.wav" for source in range(2)]
    for source, file in enumerate(files):
        soundfile.write(file, taps[:, :, source], RATE, subtype="FLOAT")
    return files


def _taps(name: str) -> np.ndarray:
    """Return the impulse responses, shape (taps, channels, sources), each source nearest to its own channel."""
    shared("")
    if name == "room":
        return room(DATA)
    angles = [int(angle) for angle in name.split("-")[1:]]
    return head(angles[0], angles[-1], DATA)
