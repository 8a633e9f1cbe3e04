"""A calibration by stepped sine: both passes recorded and turned into a model."""

from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from calibration.experiment import Emit, Plan, RawFolder
from calibration.far_field_estimate import far_field_of
from calibration.stepped_sine import Tones
from calibration.sweep_estimate import Lines, SweepEstimator
from calibration.vibrator_sweep import first_pass, second_pass
from rigkit.progress import progress
from vibractl.config import RigConfig
from vibractl.far_field import FarField
from vibractl.transfer_matrix import TransferMatrix


def measure_by_stepped_sine(
    config: RigConfig, raw: RawFolder, emit: Emit, provenance: Mapping[str, str]
) -> tuple[tuple[TransferMatrix, ...], float, FarField | None]:
    """Record silence, an even sweep, and a second one on the grid that the first asks for.

    Parameters
    ----------
    config : RigConfig
    raw : RawFolder
        Open; what it holds already is not measured again.
    emit : Emit
    provenance : mapping of strings
        The recording is added to it.

    Returns
    -------
    passes : tuple of TransferMatrix
        Each by itself; the last is the model.
    seconds : float, s
        Of signal.
    far : FarField or None
        By the last pass, where there are hydrophones.

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
    matrix, heard = measure_tones(plans[0], raw, emit, estimator, provenance)
    passes = [matrix]
    if config.characterisation.passes > 1:
        plans.append(second_pass(config, passes[0]))
        matrix, heard = measure_tones(plans[1], raw, emit, estimator, provenance)
        passes.append(matrix)
    far = None
    if config.audio.far_field_channels:
        waited = "characterisation.settle", config.characterisation.settle
        far = far_field_of(config, matrix.frequency, matrix.response, heard, matrix.frequency, waited)
    return tuple(passes), sum(plan.seconds for plan in plans), far


def measure_tones(
    plan: Plan, raw: RawFolder, emit: Emit, estimator: SweepEstimator, provenance: Mapping[str, str]
) -> tuple[TransferMatrix, np.ndarray]:
    """Record a plan of tones; each batch is estimated while the next is emitted.

    Parameters
    ----------
    plan : Plan
    raw : RawFolder, open
    emit : Emit
    estimator : SweepEstimator
    provenance : mapping of strings
        The recording is added to it.

    Returns
    -------
    matrix : TransferMatrix
    heard : complex array, shape (bins, hydrophones, coils), Pa per V
    """
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
    recording = f"{raw.path.name}/{plan.name}-*.wav, fingerprint {plan.fingerprint}"
    return estimator.joined(lines, {**provenance, "recording": recording})
