"""The vibrator's calibration over the live line: stepped sine, multisine or both, and the model they end in."""

import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

import numpy as np

from calibration.experiment import Emit, RawFolder
from calibration.multisine import FADE
from calibration.multisine_calibration import measure_by_multisine
from calibration.multisine_estimate import Levels
from calibration.stepped_calibration import measure_by_stepped_sine, measure_tones
from calibration.sweep_estimate import SweepEstimator
from calibration.uncertain_lines import merged, uncertain_lines
from calibration.vibrator_multisine import REST, longest_multisines, refuse_unfit_multisine
from calibration.vibrator_sweep import FEWEST, chosen_tones, longest_batch, longest_sweep, refuse_unfit_sweep
from rigkit.agreement import GOING_ON
from vibractl.audio import Line
from vibractl.capture import Discarded
from vibractl.config import RigConfig
from vibractl.far_field import FarField
from vibractl.shot_file import DISCARDED, keep_discarded
from vibractl.supervision import ALONE, Supervision
from vibractl.transfer_matrix import TransferMatrix

STOP_POLL = 0.1
"""s."""
SLACK = 0.01
"""s, by which whole samples may be longer."""
KIND = "vibrator calibration"
KEPT = GOING_ON.without("reference", "shot", "learning", "adaptation", "watch", "session")
"""What an unfinished one must have kept."""


@dataclass(frozen=True)
class Calibration:
    """What a calibration found.

    Parameters
    ----------
    passes : tuple of TransferMatrix
        Each pass of a stepped sine by itself, or the one model of the other methods; the last is the model.
    seconds : float, s
        Of signal emitted.
    levels : Levels or None
        Of noise and distortion, by a multisine.
    loudest : float or None, dB
        The multisine's strongest line, see `Multisined`.
    tones : array, shape (tones,), Hz
        Lines that a short stepped sine measured again.
    far : FarField or None
        Where there are hydrophones.
    over : float or None, dB
        Of a multisine's loudest line, see `Multisined`.
    """

    passes: tuple[TransferMatrix, ...]
    seconds: float
    levels: Levels | None = None
    loudest: float | None = None
    tones: np.ndarray = field(default_factory=lambda: np.zeros(0))
    far: FarField | None = None
    over: float | None = None

    @property
    def matrix(self) -> TransferMatrix:
        """The model."""
        return self.passes[-1]


class Stoppable(Protocol):
    """What says whether the calibration is to end."""

    @property
    def made(self) -> bool:
        """Whether somebody has asked for it."""


def longest_drive(config: RigConfig) -> float:
    """Return how long a drive of a calibration may be, s: a batch of tones, a multisine's silence or record."""
    settings = config.characterisation
    record = max(REST, settings.run_in + FADE) + settings.period + SLACK
    return record if settings.method == "multisine" else max(record, longest_batch(config))


class LiveLine:
    """Emits over the audio line, which is opened when the first drive comes; a context manager that closes it.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        Keeps the recordings that are discarded, in a folder of their own.
    stop : Stoppable
        Ramps the drive down in the middle of a batch when it is made.
    supervision : Supervision
        Of the line.
    """

    def __init__(self, config: RigConfig, raw: RawFolder, stop: Stoppable, supervision: Supervision = ALONE) -> None:
        self._config, self._stop, self._discarded = config, stop, raw.path / DISCARDED
        self._supervision = supervision
        self.line: Line | None = None
        """From the first drive on, until it is closed."""

    def __enter__(self) -> Self:
        """Wait for the first drive."""
        return self

    def __exit__(self, *fault: object) -> None:
        """Close the line, if it was opened."""
        try:
            if self.line is not None:
                self.line.__exit__(*fault)
        finally:
            self.line = None

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Play `drive` (samples, drives) V; return what was emitted, and responses and far field: `experiment.Emit`.

        Raises
        ------
        Stopped : it was asked for.
        """
        if self.line is None:
            line = Line(
                self._config,
                seconds=longest_drive(self._config),
                on_discard=self._keep_discarded,
                supervision=self._supervision,
            )
            self.line = line.__enter__()
        done = threading.Event()
        watch = threading.Thread(target=self._stop_when_asked, args=(self.line, done), daemon=True)
        watch.start()
        try:
            capture = self.line.emit(drive)
        finally:
            done.set()
            watch.join()
        return capture.emitted, np.hstack([capture.response, capture.far_field])

    def _stop_when_asked(self, line: Line, done: threading.Event) -> None:
        while not done.wait(STOP_POLL):
            if self._stop.made:
                line.stop()

    def _keep_discarded(self, discarded: Discarded) -> None:
        kept = keep_discarded(self._discarded, "batch", discarded, self._config)
        sys.stderr.write(f"recording discarded, attempt {discarded.attempt}: {discarded.reason}; kept as {kept}\n")


def calibrate(config: RigConfig, raw: RawFolder, emit: Emit, about: Mapping[str, str]) -> Calibration:
    """Measure the transfer matrix by `characterisation.method`.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        Open; what it holds already is not measured again.
    emit : Emit
    about : mapping of str to str
        The model's words.

    Returns
    -------
    Calibration
    """
    if config.characterisation.method == "stepped":
        passes, seconds, far = measure_by_stepped_sine(config, raw, emit, about)
        return Calibration(passes, seconds, far=far)
    found = measure_by_multisine(config, raw, emit, about)
    by_multisine = Calibration(
        (found.matrix,), found.emitted, found.levels, found.loudest, far=found.far, over=found.over
    )
    tones = uncertain_lines(found.matrix) if config.characterisation.method == "both" else np.zeros(0)
    if len(tones) < FEWEST:
        return by_multisine
    plan = chosen_tones(config, tones)
    again, _ = measure_tones(plan, raw, emit, SweepEstimator(config), about)
    model = merged(found.matrix, again)
    return replace(by_multisine, passes=(model,), seconds=found.emitted + plan.seconds, tones=tones)


def refuse_unfit(config: RigConfig) -> None:
    """Refuse a calibration that could not end in a model: too loud for the guard, or too few lines.

    Raises
    ------
    ValueError : it says which setting, and what is allowed.
    """
    settings = config.characterisation
    if settings.quiet and settings.method != "multisine":
        raise ValueError(
            f"characterisation.quiet is true, but method is {settings.method}, must be multisine: tones are not quiet"
        )
    if settings.around == "reference" and (settings.quiet or settings.method != "multisine"):
        what = "quiet is true" if settings.quiet else f"method is {settings.method}, must be multisine"
        raise ValueError(f"characterisation.around is reference, must be band: characterisation.{what}")
    if settings.method != "multisine":
        refuse_unfit_sweep(config)
    if settings.method != "stepped":
        refuse_unfit_multisine(config)


def require_room(config: RigConfig, raw: RawFolder) -> None:
    """Refuse, by a `DiskFault`, a calibration that the disk has no room for.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        What it has already needs no room.
    """
    audio, method = config.audio, config.characterisation.method
    seconds = longest_sweep(config) * (method == "stepped") + longest_multisines(config) * (method != "stepped")
    heard = len(audio.response_channels) + len(audio.far_field_channels)
    raw.require_room(round(seconds * audio.rate), len(audio.drive_channels) + heard)
