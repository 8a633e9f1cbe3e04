"""Amplifiers that clip softly before measured impulse responses, and sensors behind them."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.impulse_response import ImpulseResponsePlant
from firmware_sim.plants.reception import BLOCK, Receiver, Reception, in_blocks
from firmware_sim.plants.steady_kernel import clip_softly

LINES = 8
"""Of a spectrum to a hertz: responses of a second and less are smooth between them."""


@dataclass(frozen=True)
class MeasuredExciter:
    """A rig as somebody measured it, with a simulated amplifier and simulated sensors.

    Parameters
    ----------
    taps : array, shape (taps, sensors, drives), m/s^2 per V, a sample
    rate : float, samples/s
        Of the taps; it runs at no other.
    clip : float, V
        Where the drive saturates; 0: nowhere.
    sharpness : int, 1, 2 or 4
    reception : Reception
    """

    taps: np.ndarray
    rate: float
    clip: float
    sharpness: int
    reception: Reception


class MeasuredExciterPlant:
    """A `MeasuredExciter` sample by sample, from rest; it does not drift.

    Parameters
    ----------
    exciter : MeasuredExciter
    rate : float, samples/s
    seed : int
        Of its noise and of what wanders.
    """

    def __init__(self, exciter: MeasuredExciter, rate: float, seed: int) -> None:
        if rate != exciter.rate:
            raise ValueError(f"rate is {rate!r} samples/s, must be {exciter.rate:g}: the responses were measured so")
        self._exciter, self._responses = exciter, ImpulseResponsePlant(exciter.taps)
        self._receiver = Receiver(exciter.reception, rate, seed)
        self._clipped = np.zeros((BLOCK, exciter.taps.shape[2]))
        self._done = 0

    def run(self, drive: np.ndarray, heard: np.ndarray) -> None:
        """Go on for `drive`, shape (frames, drives) V, and fill `heard`, shape (frames, sensors) m/s^2."""
        for part, begins in in_blocks(self._done, len(drive)):
            if begins:
                self._receiver.begin_block()
            clipped = self._clipped[: part.stop - part.start]
            clip_softly(drive[part], self._exciter.clip, self._exciter.sharpness, clipped)
            self._responses.run(clipped, heard[part])
            self._receiver.hear(heard[part])
        self._done += len(drive)


def measured_response(exciter: MeasuredExciter, frequency: np.ndarray) -> np.ndarray:
    """Return G for a small drive, shape (bins, sensors, drives), m/s^2 per V.

    Parameters
    ----------
    exciter : MeasuredExciter
    frequency : array, shape (bins,), Hz
    """
    lines = round(exciter.rate * LINES)
    spectrum = np.fft.rfft(exciter.taps, lines, axis=0)
    below = np.minimum((frequency * LINES).astype(int), len(spectrum) - 2)
    share = (frequency * LINES - below)[:, None, None]
    response = (1 - share) * spectrum[below] + share * spectrum[below + 1]
    whole: np.ndarray = exciter.reception.sensors.response(frequency)[:, :, None] * response
    return whole
