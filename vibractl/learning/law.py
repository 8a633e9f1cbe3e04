"""Everything one run's learning stands on: lines, inverse, reference, gains, first drive; made once, never changed."""

from dataclasses import dataclass

import numpy as np

from vibractl.config import Learning
from vibractl.learning.gains import Gains
from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.laws import SIGNIFICANT, ByInverse, ByScaledReference, VibratorLaw
from vibractl.transfer_matrix import TransferMatrix, line_weights, regularized_inverse


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


def reference_level(lines: np.ndarray) -> np.ndarray:
    """Return the level (outputs,) of a reference's lines (lines, outputs), m/s^2 s: rms of the significant ones."""
    size = np.abs(lines)
    strong = size > SIGNIFICANT * size.max(axis=0)
    level: np.ndarray = np.sqrt((size**2 * strong).sum(axis=0) / strong.sum(axis=0))
    return level
