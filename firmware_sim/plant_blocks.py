"""The simulated plants as blocks; the plants themselves know neither blocks nor ports."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.recording import read
from firmware_sim.plants.impulse_response import ImpulseResponsePlant
from firmware_sim.plants.vibrator import VibratorPlant


class Vibrator(Block):
    """The simulated marine vibrator, at rest after every `prepare`; `VibratorPlant` says what it models.

    Ports: `drive` (V) in, `response` (m/s^2) out, two wide.

    Parameters
    ----------
    seed : int, which vibrator
    nonlinearity : float, 1
    drift : float, 1
    noise : float, dB re 10 m/s^2
    hum : float, dB re 10 m/s^2
    hum_frequency : float, Hz
    """

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    def __init__(
        self,
        seed: int = 1,
        nonlinearity: float = 1.0,
        drift: float = 0.002,
        noise: float = -75.0,
        hum: float = -60.0,
        hum_frequency: float = 50.0,
    ) -> None:
        self._options = seed, nonlinearity, drift, noise, hum, hum_frequency
        self._plant = VibratorPlant(44_100.0, *self._options)  # refuses a wrong option here and now

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self._plant = VibratorPlant(rate, *self._options)

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Run it over one frame."""
        self._plant.run(drive, response)


class ImpulseResponse(Block):
    """Anybody's rig as far as it is linear, from measured impulse responses.

    Ports: `drive` (V), as wide as there are files, in; `response` (m/s^2), as wide as the files have channels, out.

    Parameters
    ----------
    files : list of str or Path
        One WAV file per drive: what each accelerometer, a channel each, gives after an impulse of one volt and one
        sample on that drive.  Shorter files are continued with zeros.
    gain : float, m/s^2 per V for a file's 1.0, finite and not 0

    Raises
    ------
    ValueError : a file is not whole, is empty or not finite, or files differ in rate or channels.
    """

    def __init__(self, files: Sequence[str | Path], gain: float = 1.0) -> None:
        if isinstance(files, str | Path) or not files:
            raise ValueError(f"files is {files!r}, must be a list with one WAV file per drive")
        if not (np.isfinite(gain) and gain != 0):
            raise ValueError(f"gain is {gain!r}, must be finite and not 0 m/s^2 per V")
        self._files = files
        self._rate, self._taps = _read(files)
        self._taps *= gain
        _, responses, drives = self._taps.shape
        self.inputs = (Port("drive", "V", drives),)
        self.outputs = (Port("response", "m/s^2", responses),)
        self._plant = ImpulseResponsePlant(self._taps)

    def prepare(self, rate: float, frames: int) -> None:
        """Forget all drives.

        Raises
        ------
        ValueError : the files have another rate.
        """
        if rate != self._rate:
            raise ValueError(f"{self._files[0]}: {self._rate:g} samples/s, must be {rate:g}")
        self._plant.reset()

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Convolve one frame."""
        self._plant.run(drive, response)


def _read(files: Sequence[str | Path]) -> tuple[float, np.ndarray]:
    """Return the rate and the taps, shape (taps, responses, drives)."""
    first = read(files[0])
    columns = [first.data, *(read(file, rate=first.rate, channels=first.data.shape[1]).data for file in files[1:])]
    taps = np.zeros((max(map(len, columns)), first.data.shape[1], len(columns)))
    for drive, column in enumerate(columns):
        taps[: len(column), :, drive] = column
    return first.rate, taps
