"""The learning law of a run, from its settings, the rig's model and the reference."""

import numpy as np
from scipy.signal.windows import hann

from vibractl.config import Learning
from vibractl.fft_plans import Plans
from vibractl.learning.gains import Gains
from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.law import Law, bounded_inverse, first_law
from vibractl.learning.laws import Plant
from vibractl.reference import Reference
from vibractl.spectrum import Decimator, LineSpectrum
from vibractl.transfer_matrix import TransferMatrix

SETTLED = 0.1
"""Part of a sine, beside its taper and at each end, that is not looked at: only its steady state is learned."""


def learning_law(settings: Learning, matrix: TransferMatrix, reference: Reference, rate: float, plans: Plans) -> Law:
    """Build the law of a run from its settings, the rig's model and the reference.

    Parameters
    ----------
    settings : Learning
    matrix : TransferMatrix, of the whole rig
    reference : Reference, as wide as the outputs controlled
    rate : float, samples/s, of the reference
    plans : Plans

    Raises
    ------
    ValueError : a side that is not there, gains or a structure that do not fit, or lines outside the model.

    Source
    ------
    Sörnmo 2015, eq. (6.10)-(6.19), (6.24), (6.25).
    """
    if settings.structure == "decentralised" and not KINDS[settings.law].decentralised:
        able = " or ".join(name for name, kind in KINDS.items() if kind.decentralised)
        raise ValueError(f"learning.structure is decentralised: learning.law is {settings.law}, must be {able}")
    outputs, spread = _structure(settings.structure, settings.side, matrix)
    lines = _lines(settings, reference, rate, plans)
    used = _as_driven(matrix.at(lines.frequency), outputs, spread, settings.structure)
    window = settled_window(reference, lines.frames)
    wanted = lines.lines(window * Decimator(settings.decimation).apply(reference.signal))
    if settings.weights and settings.sensors == "accelerometers":  # those of the outputs controlled
        settings = settings.model_copy(update={"weights": tuple(settings.weights[output] for output in outputs)})
    weighted = settings if settings.sensors == "accelerometers" else settings.model_copy(update={"weights": ()})
    inverse = bounded_inverse(used.response, weighted)
    start = first_law(settings).first(Plant(used.response, inverse, wanted))
    active = np.ones(len(lines.frequency))
    if reference.root is not None:
        active = _overtones(lines.frequency, reference.root, settings.overtones)
        start = start * active[:, None]
    gains = _gains(settings, reference)
    return Law(used, inverse, settings, wanted, start, gains, active, outputs, spread, window)


def settled_window(reference: Reference, frames: int) -> np.ndarray | float:
    """Return a window (frames, 1) of mean 1 over the steady state of a sine; 1 for anything else.

    Over its whole length, the ends of a sine would be made up for by overtones that last from end to end.
    """
    if reference.root is None:
        return 1.0
    aside = round(min(reference.taper + SETTLED, 0.45) * frames)
    window = np.zeros((frames, 1))
    window[aside : frames - aside, 0] = hann(frames - 2 * aside, sym=False)
    settled: np.ndarray = window / window.mean()
    return settled


def _structure(structure: str, side: int, matrix: TransferMatrix) -> tuple[tuple[int, ...], np.ndarray]:
    if side:
        sides = min(matrix.outputs, matrix.inputs)
        if side > sides:
            raise ValueError(f"learning.side is {side}, must be 0 to {sides}")
        return (side - 1,), np.eye(matrix.inputs)[:, side - 1 : side]
    outputs = tuple(range(matrix.outputs))
    return outputs, np.ones((matrix.inputs, 1)) if structure == "common" else np.eye(matrix.inputs)


def _as_driven(matrix: TransferMatrix, outputs: tuple[int, ...], spread: np.ndarray, structure: str) -> TransferMatrix:
    """Return the matrix from the learned inputs to the controlled outputs."""
    rows = list(outputs)
    response = matrix.response[:, rows] @ spread
    variance = matrix.variance[:, rows] @ np.abs(spread)
    coherence = np.minimum(matrix.coherence[:, rows] @ np.abs(spread), 1.0)
    if structure == "decentralised":
        response = response * np.eye(*response.shape[1:])
    return TransferMatrix(matrix.frequency, response, variance, coherence, matrix.provenance)


def _lines(settings: Learning, reference: Reference, rate: float, plans: Plans) -> LineSpectrum:
    frames, width = reference.signal.shape
    return LineSpectrum(frames // settings.decimation, width, rate / settings.decimation, settings.band, plans)


def _overtones(frequency: np.ndarray, root: float, overtones: int) -> np.ndarray:
    """Mark the root and its overtones, (6.13)."""
    order = np.round(frequency / root)
    spacing = frequency[1] - frequency[0]
    near = np.abs(frequency - order * root) < 0.5 * spacing
    return np.where(near & (order >= 1) & (order <= overtones + 1), 1.0, 0.0)


def _gains(settings: Learning, reference: Reference) -> Gains:
    if settings.gains:
        return Gains(settings.gains, settings.stages)
    if settings.stages:
        raise ValueError(f"learning.stages is {list(settings.stages)}, but learning.gains is empty")
    kind = KINDS[settings.law]
    return kind.gains if reference.root is None else kind.tonal_gains
