"""Before a run learns: a weak burst, and whether its response is what the model says, channel by channel."""

from dataclasses import dataclass

import numpy as np

from rigkit.agreement import CHANNELS, DisagreementError
from vibractl.decibels import rms
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.changed_rig import OFF, Change, change_of, difference, mismatch, unexplained
from vibractl.learning.laws import strong_lines
from vibractl.learning.shot import Shot
from vibractl.setup import Setup
from vibractl.spectrum import Decimator

LEVEL_DB = -12.0
"""Of the burst, re the first drive of the run at full level."""
LEAD, BURST, TAIL = 0.2, 2.0, 1.0
"""s of silence, of the burst, and of silence while it rings down."""
SECONDS = LEAD + BURST + TAIL
SUDDEN = 2.0
"""Times the mismatch of the shots before: what a machine comes to by and by is no change of its channels."""
EDGE = 0.25
"""Part of the burst that rises, and that falls."""


class ChangedRigError(DisagreementError):
    """The rig is not the one that was calibrated; the text names the channels."""

    def __init__(self, folder: str, where: str, change: Change) -> None:
        self.change = change.text
        super().__init__(
            f"{folder}{where}: this is not the rig that was calibrated: {change.text} (the model is off by "
            f"{change.off:.2g} of the response, with that by {change.left:.2g}); set it right and go on with "
            f"--resume {folder}, measure a new model, or go on all the same with --accept {CHANNELS}"
        )


@dataclass(frozen=True, eq=False)
class RigCheck:
    """A burst in which every input has phases of its own, so that each channel is known by its signal.

    Parameters
    ----------
    drive : float32 array, shape (samples, coils), V
    lines : complex array, shape (lines, inputs), V s, of the inputs learned
    frequency : array, shape (lines,), Hz
    inside : int array, shape (lines,)
        Which lines of the whole burst those are.
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
        The model.
    outputs : tuple of ints, accelerometers, counted from 0
    step : int
        Decimation of what is transformed.
    """

    drive: np.ndarray
    lines: np.ndarray
    frequency: np.ndarray
    inside: np.ndarray
    response: np.ndarray
    outputs: tuple[int, ...]
    step: int

    @classmethod
    def of(cls, made: Setup, loudest: np.ndarray, level: float = 1.0) -> "RigCheck":
        """Make the burst of a run.

        Parameters
        ----------
        made : Setup
        loudest : array, shape (samples, coils), V
            The first drive, beside which the burst is weak.
        level : float, 1
            Of that drive; a faint one's burst is as faint as it is itself.
        """
        weaker = min(1.0, 10 ** (LEVEL_DB / 20) / level)
        config, law = made.config, made.law
        step, rate = config.learning.decimation, config.audio.rate
        low, high = config.characterisation.preload_band
        lead, burst, tail = (step * round(seconds * rate / step) for seconds in (LEAD, BURST, TAIL))
        signal = np.zeros((lead + burst + tail, law.spread.shape[1]))
        signal[lead : lead + burst] = _burst(burst, rate, (low, high), signal.shape[1])
        signal *= float(rms(loudest).max()) * weaker / float(rms(signal @ law.spread.T).max())
        frequency = np.fft.rfftfreq(len(signal) // step, step / rate)
        inside = np.flatnonzero((frequency >= low) & (frequency <= high) & law.matrix.covers(frequency))
        lines = np.fft.rfft(Decimator(step).apply(signal), axis=0)[inside]
        response = law.matrix.at(frequency[inside]).response
        drive = (signal @ law.spread.T).astype(np.float32)
        return cls(drive, lines, frequency[inside], inside, response, law.outputs, step)

    def judge(self, response: np.ndarray) -> tuple[float, float, Change | None]:
        """Return by how much the model is off, re the response and as of `mismatch`, 1, and what has been changed.

        Parameters
        ----------
        response : array, shape (samples, responses), m/s^2
        """
        heard = np.fft.rfft(Decimator(self.step).apply(response[:, list(self.outputs)]), axis=0)[self.inside]
        off = unexplained(self.response, self.lines, heard)
        worst = mismatch(self.response, self.lines, heard)
        return off, worst, change_of(self.response, self.lines, heard, self.frequency)


def changed_channels(
    algorithm: Algorithm, shot: Shot, usual: float | None = None
) -> tuple[float | None, Change | None]:
    """Return what has changed about the rig since the shot before, as strong lines show it to what is believed of G.

    And what the next shot is to be held against: a channel that changes within a shot spoils that one in a way that
    nothing explains, and the next one is no further off than that.  Where the response is that of the shot before, no
    channel has changed, whatever is believed of G: an accelerometer whose clock runs slow makes that belief poor.

    Parameters
    ----------
    algorithm : Algorithm
    shot : Shot
    usual : float, 1, optional
        By how much the burst, or the last shot before one that nothing explained, was off.
    """
    law, before = algorithm.law, algorithm.belief.before
    strong = strong_lines(law.reference) & (law.active > 0)
    response, drive, heard = algorithm.belief.response[strong], shot.drive[strong], shot.response[strong]
    off, known, has_moved = mismatch(response, drive, heard), usual, True
    if before is not None:
        last = mismatch(response, before.drive[strong], before.response[strong])
        known = last if usual is None else min(last, usual)
        if off < SUDDEN * known:
            return None, None
        has_moved = difference(before.response[strong], heard) > OFF
    change = change_of(response, drive, heard, law.matrix.frequency[strong]) if has_moved else None
    is_sudden = known is not None and off >= SUDDEN * known
    return known if is_sudden and change is None else None, change


def _burst(samples: int, rate: float, band: tuple[float, float], inputs: int) -> np.ndarray:
    """Return a signal (samples, inputs) of rms about 1 in a band, in which every input has phases of its own."""
    frequency = np.fft.rfftfreq(samples, 1 / rate)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    phase = np.random.default_rng(inputs).uniform(0, 2 * np.pi, (np.count_nonzero(inside), inputs))
    lines = np.zeros((len(frequency), inputs), complex)
    lines[inside] = np.exp(1j * phase)
    rise = np.sin(0.5 * np.pi * np.clip(np.arange(samples) / (EDGE * samples), 0, 1)) ** 2
    signal: np.ndarray = np.fft.irfft(lines, samples, axis=0) * (rise * rise[::-1])[:, None]
    return signal
