"""The simulated plants as blocks; the plants themselves know neither blocks nor ports."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ctlblocks.block import Block, Port
from ctlblocks.recording import read
from firmware_sim.plants.impulse_response import ImpulseResponsePlant
from firmware_sim.plants.options import chosen
from firmware_sim.plants.vibrator import LumpedVibratorPlant, VibratorPlant
from firmware_sim.plants.vibrator_array import ArrayOptions, VibratorArrayPlant
from firmware_sim.plants.vibrator_options import VibratorOptions


@dataclass(eq=False, kw_only=True)
class Vibrator(VibratorOptions, Block):
    """The simulated marine vibrator, at rest after every `prepare`; `VibratorPlant` says what it models.

    Ports: `drive` (V) in, `response` (m/s^2) out, two wide.  Parameters: those of `VibratorOptions`.
    """

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    def __post_init__(self) -> None:
        """Refuse a wrong option here and now."""
        self.prepare(44_100.0, 1)

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self._plant = VibratorPlant(rate, **chosen(self, VibratorOptions))

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Run it over one frame."""
        self._plant.run(drive, response)


@dataclass(eq=False, kw_only=True)
class VibratorArray(ArrayOptions, Block):
    """Vibrators side by side and hydrophones before them, at rest after every `prepare`; see `VibratorArrayPlant`.

    Ports: `drive` (V), two a vibrator, in; `response` (m/s^2), two a vibrator, and `far_field` (Pa), one a hydrophone,
    out.  Parameters: those of `ArrayOptions`.
    """

    def __post_init__(self) -> None:
        """Refuse a wrong option here and now."""
        self.prepare(44_100.0, 1)
        self.inputs = (Port("drive", "V", 2 * self.vibrators),)
        self.outputs = (Port("response", "m/s^2", 2 * self.vibrators), Port("far_field", "Pa", self.hydrophones))

    def prepare(self, rate: float, frames: int) -> None:
        """Build it anew, at rest."""
        self._plant = VibratorArrayPlant(rate, **chosen(self, ArrayOptions))

    def process(self, drive: np.ndarray, response: np.ndarray, far_field: np.ndarray) -> None:
        """Run it over one frame."""
        self._plant.run(drive, response, far_field)


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


@dataclass(eq=False, kw_only=True)
class VibratorImpulseResponse(VibratorOptions, Block):
    """The coils, springs and shells of the simulated vibrator, and behind them what was measured elsewhere.

    The two shells, with all their nonlinear forces and without flexure, move what the impulse responses start from;
    sensors with noise and hum hear what they end in.

    Ports: `drive` (V) in, `response` (m/s^2) out, two wide.

    Parameters
    ----------
    files : list of str or Path
        Two WAV files with two channels: what each accelerometer, a channel each, gives after an impulse of one shell.
    gain : float, m/s^2 per m/s^2 for a file's 1.0, finite and not 0
        So that the responses are about as large as the shells' motion in the band that is wanted: the overtones are
        then those of the simulated vibrator.

    Others: those of `VibratorOptions`.

    Raises
    ------
    ValueError : an option outside its range; there are not two whole, finite files with two channels at one rate.
    """

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    files: Sequence[str | Path]
    gain: float = 1.0

    def __post_init__(self) -> None:
        """Read the files and refuse a wrong option here and now."""
        super().__post_init__()
        self._path = ImpulseResponse(self.files, self.gain)
        widths = self._path.outputs[0].width, self._path.inputs[0].width
        if widths != (2, 2):
            raise ValueError(f"files: {widths[1]} with {widths[0]} channels, must be two with two")

    def prepare(self, rate: float, frames: int) -> None:
        """Build the shells anew, at rest, and forget how they moved."""
        self._path.prepare(rate, frames)
        self._vibrator = LumpedVibratorPlant(rate, **chosen(self, VibratorOptions))
        self._shells = np.zeros((frames, 2))

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Move the shells over one frame, convolve, and listen."""
        shells = self._shells[: len(drive)]
        self._vibrator.accelerate(drive, shells)
        self._path.process(shells, response)
        self._vibrator.pick_up(response)


def _read(files: Sequence[str | Path]) -> tuple[float, np.ndarray]:
    """Return the rate and the taps, shape (taps, responses, drives)."""
    first = read(files[0])
    columns = [first.data, *(read(file, rate=first.rate, channels=first.data.shape[1]).data for file in files[1:])]
    taps = np.zeros((max(map(len, columns)), first.data.shape[1], len(columns)))
    for drive, column in enumerate(columns):
        taps[: len(column), :, drive] = column
    return first.rate, taps
