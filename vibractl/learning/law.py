"""Everything one run's learning stands on: lines, inverse, reference, gains, first drive; made once, never changed."""

from dataclasses import dataclass

import numpy as np
from scipy.signal.windows import hann

from vibractl.config import Learning
from vibractl.fft_plans import Plans
from vibractl.learning.gains import Gains
from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.laws import SIGNIFICANT, ByInverse, ByScaledReference, Plant, VibratorLaw
from vibractl.reference import Reference
from vibractl.spectrum import Decimator, LineSpectrum
from vibractl.transfer_matrix import TransferMatrix, line_weights, regularized_inverse

SETTLED = 0.1
"""Part of a sine, beside its taper and at each end, that is not looked at: only its steady state is learned."""


@dataclass(frozen=True)
class Law:
    """The learning law of one run.

    Parameters
    ----------
    matrix : TransferMatrix, on the lines learned, of the inputs and outputs that are used
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
        Of the model.
    settings : Learning
    reference : complex array, shape (lines, outputs), m/s^2 s
    start : complex array, shape (lines, inputs), V s
        The first drive.
    gains : Gains
    active : array, shape (lines,), 1
        1 on lines that are learned, 0 on others.
    outputs : tuple of ints
        Accelerometers that are controlled, counted from 0.
    spread : array, shape (coils, inputs), 1
        Which coils each learned input drives.
    window : array, shape (frames, 1), or 1.0
        By which responses are multiplied before they are transformed.
    edge, rest : float, s
        The drive's raised cosines at both ends, and how long it rests then until the frame's end.
    importance : array, shape (lines,), or 1.0
        How much a line counts where one is better only as another is worse.
    """

    matrix: TransferMatrix
    inverse: np.ndarray
    settings: Learning
    reference: np.ndarray
    start: np.ndarray
    gains: Gains
    active: np.ndarray
    outputs: tuple[int, ...]
    spread: np.ndarray
    window: np.ndarray | float = 1.0
    edge: float = 0.0
    rest: float = 0.0
    importance: np.ndarray | float = 1.0

    @property
    def is_tonal(self) -> bool:
        """Whether lines stand apart: a sine's root and overtones."""
        return bool(np.any(self.active == 0.0))

    @property
    def counts_less(self) -> np.ndarray:
        """Lines that count less than others, bool (lines,): which are not judged."""
        importance = np.broadcast_to(self.importance, len(self.active))
        less: np.ndarray = importance < importance.max()
        return less

    @property
    def weight(self) -> np.ndarray:
        """How much each line of each output counts, (lines, outputs), 1."""
        outputs = np.array(self.settings.weights or np.ones(self.reference.shape[1]))
        weight: np.ndarray = np.reshape(self.importance, (-1, 1)) * np.broadcast_to(outputs, self.reference.shape)
        return weight


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


def first_law(settings: Learning) -> VibratorLaw:
    """Return the law that gives the drive to begin with, as the settings say."""
    if settings.start in ("by-law", "library"):  # what the library has is checked first, and may be refused
        return KINDS[settings.law].law
    return ByInverse() if settings.start == "inverse" else ByScaledReference()


def bounded_inverse(response: np.ndarray, settings: Learning) -> np.ndarray:
    """Return G^+ as the settings bound it, (6.19), with each output's weight.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    settings : Learning
        `weights` as many as outputs, or none.

    Returns
    -------
    complex array, shape (lines, inputs, outputs), V per m/s^2
        (G^H W^2 G + eps I)^-1 G^H W^2, which makes ||W (R - G U)|| small.
    """
    if settings.weights:
        weight = np.array(settings.weights)
        plain = settings.model_copy(update={"weights": ()})
        weighted: np.ndarray = bounded_inverse(weight[:, None] * response, plain) * weight
        return weighted
    if settings.regularisation == "per-line":
        return regularized_inverse(response, line_weights(response, settings.epsilon, settings.floor))
    return regularized_inverse(response, settings.constant_epsilon)


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


def reference_level(lines: np.ndarray) -> np.ndarray:
    """Return the level (outputs,) of a reference's lines (lines, outputs), m/s^2 s: rms of the significant ones."""
    size = np.abs(lines)
    strong = size > SIGNIFICANT * size.max(axis=0)
    level: np.ndarray = np.sqrt((size**2 * strong).sum(axis=0) / strong.sum(axis=0))
    return level


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
