"""The vibrator's calibration: both passes of the stepped sine over the live line, and the model they end in."""

import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from calibration.experiment import Emit, Plan, RawFolder
from calibration.stepped_sine import Tones
from calibration.sweep_estimate import Lines, SweepEstimator
from calibration.vibrator_sweep import first_pass, longest_batch, second_pass
from rigkit import config as rig_file
from rigkit.progress import progress
from rigkit.provenance import now, software
from rigkit.stop import StopRequest
from vibractl.audio import Line
from vibractl.capture import Discarded
from vibractl.config import RigConfig
from vibractl.shot_file import DISCARDED, keep_discarded
from vibractl.transfer_matrix import TransferMatrix

STOP_POLL = 0.1
"""s."""


@dataclass(frozen=True)
class Calibration:
    """What a calibration found.

    Parameters
    ----------
    passes : tuple of TransferMatrix
        Each pass by itself; the last is the model.
    seconds : float, s
        Of signal.
    """

    passes: tuple[TransferMatrix, ...]
    seconds: float

    @property
    def matrix(self) -> TransferMatrix:
        """The model."""
        return self.passes[-1]


class LiveLine:
    """Emits over the audio line, which is opened when the first drive comes; a context manager that closes it.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        Keeps the recordings that are discarded, in a folder of their own.
    stop : StopRequest
        Ramps the drive down in the middle of a batch when it is made.
    """

    def __init__(self, config: RigConfig, raw: RawFolder, stop: StopRequest) -> None:
        self._config, self._stop, self._discarded = config, stop, raw.path / DISCARDED
        self._line: Line | None = None

    def __enter__(self) -> Self:
        """Wait for the first drive."""
        return self

    def __exit__(self, *fault: object) -> None:
        """Close the line, if it was opened."""
        if self._line is not None:
            self._line.__exit__(*fault)

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Play `drive` (samples, drives) V; return what was emitted and the responses, see `experiment.Emit`.

        Raises
        ------
        Stopped : it was asked for.
        """
        if self._line is None:
            line = Line(self._config, seconds=longest_batch(self._config), on_discard=self._keep_discarded)
            self._line = line.__enter__()
        done = threading.Event()
        watch = threading.Thread(target=self._stop_when_asked, args=(self._line, done), daemon=True)
        watch.start()
        try:
            capture = self._line.emit(drive)
        finally:
            done.set()
            watch.join()
        return capture.emitted, capture.response

    def _stop_when_asked(self, line: Line, done: threading.Event) -> None:
        while not done.wait(STOP_POLL):
            if self._stop.made:
                line.stop()

    def _keep_discarded(self, discarded: Discarded) -> None:
        kept = keep_discarded(self._discarded, "batch", discarded, self._config)
        sys.stderr.write(f"recording discarded, attempt {discarded.attempt}: {discarded.reason}; kept as {kept}\n")


def calibrate(config: RigConfig, raw: RawFolder, emit: Emit) -> Calibration:
    """Measure the transfer matrix: silence, an even sweep, and a second one on the grid that the first asks for.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        Open; what it holds already is not measured again.
    emit : Emit

    Returns
    -------
    Calibration

    Source
    ------
    Sörnmo 2015, sec. 6.5-6.6.

    Departs
    -------
    The second pass alone is the model where there is one: weighing in the first would gain a tenth if nothing moved,
    but it is older by a quarter of an hour of drift.
    """
    estimator = SweepEstimator(config)
    plans = [first_pass(config)]
    passes = [_measured(plans[0], raw, emit, estimator, config)]
    if config.characterisation.passes > 1:
        plans.append(second_pass(config, passes[0]))
        passes.append(_measured(plans[1], raw, emit, estimator, config))
    return Calibration(tuple(passes), sum(plan.seconds for plan in plans))


def _measured(plan: Plan, raw: RawFolder, emit: Emit, estimator: SweepEstimator, config: RigConfig) -> TransferMatrix:
    """Record a pass; each batch is estimated while the next is emitted."""
    lines: list[Lines] = []
    waiting: Future[Lines] | None = None
    done, title = 0.0, f"{plan.name}, {plan.seconds / 60:.1f} min of signal"
    with ThreadPoolExecutor(1) as pool, progress(title, plan.seconds, start=raw.recorded(plan)) as meter:
        for batch, record in raw.record(plan, emit):
            if waiting is not None:
                lines.append(waiting.result())
            if isinstance(batch, Tones):
                waiting = pool.submit(estimator.lines, batch, record)
            else:
                estimator.hear_silence(record)
            done += batch.samples / plan.rate
            meter.show(done)
        if waiting is not None:
            lines.append(waiting.result())
    return estimator.joined(lines, _provenance(config, raw.path, plan))


def _provenance(config: RigConfig, raw: Path, plan: Plan) -> dict[str, str]:
    return {
        "rig": config.rig.name,
        "config": rig_file.dump(config),
        "recording": f"{raw.name}/{plan.name}-*.wav, fingerprint {plan.fingerprint}",
        "software": software(),
        "date": now(),
    }
