"""A plant in lines, for tests of what learns from shot to shot: G, noise, and overtones of what it does in its band."""

import numpy as np

from vibractl.config import Learning
from vibractl.fft_plans import Plans
from vibractl.learning.law import Law
from vibractl.learning.law_of_run import learning_law
from vibractl.learning.shot import Shot
from vibractl.reference import reference_from
from vibractl.transfer_matrix import TransferMatrix

RATE = 44_100.0
FREQUENCY = np.arange(14.0, 652.0)
STRONG = (FREQUENCY >= 40) & (FREQUENCY <= 90)


def modal(outputs: int, inputs: int, modes: int = 12) -> np.ndarray:
    """Return a response (lines, outputs, inputs), m/s^2 per V, with resonances and notches, never near singular."""
    rng = np.random.default_rng(outputs + 10 * inputs)
    own = np.geomspace(30, 600, modes)
    shape = 1j * FREQUENCY[:, None] / (own**2 - FREQUENCY[:, None] ** 2 + 0.2j * own * FREQUENCY[:, None])
    residues = 5.0 * rng.standard_normal((modes, outputs, inputs))
    return np.eye(outputs, inputs) + np.einsum("lm,moi->loi", shape, residues)


def matrix_of(response: np.ndarray, deviation: float = 1e-3) -> TransferMatrix:
    """Return a model that is as uncertain as that, re each element."""
    variance = deviation**2 * np.abs(response) ** 2
    return TransferMatrix(FREQUENCY, response, variance, np.ones(response.shape))


def law_of(matrix: TransferMatrix, reference: str = "chirp:40:90:1", **settings: object) -> Law:
    """Return the law of a run on that model, lines 1 Hz apart."""
    chosen = Learning.model_validate(settings)
    outputs = 1 if chosen.side else matrix.outputs
    return learning_law(chosen, matrix, reference_from(reference, RATE, 10.0, 0.04, outputs, 4), RATE, Plans())


class LinePlant:
    """Answers with G U, distortion and noise.

    Parameters
    ----------
    response : complex array, shape (model's lines, outputs, inputs), m/s^2 per V
    law : Law
        Whose lines are driven.
    noise : float, m/s^2 s, rms of a line
    distortion : float, 1, of a weak line, re a strong one of the reference
    """

    def __init__(self, response: np.ndarray, law: Law, noise: float = 1e-6, distortion: float = 0.0) -> None:
        lines = law.matrix.frequency
        self.response = response[np.searchsorted(FREQUENCY, lines)]
        self.noise, self._rng = noise, np.random.default_rng(1)
        self._wanted, self._strong = law.reference, (lines >= 40) & (lines <= 90)
        level = distortion * np.abs(law.reference).max()
        self._distortion = np.where(self._strong[:, None], 0.0, level * self._draw(law.reference.shape))

    def shot(self, drive: np.ndarray) -> Shot:
        """Answer one drive; the silence before it tells the noise."""
        linear = (self.response @ drive[..., None])[..., 0]
        noise = np.full(linear.shape, self.noise**2)
        return Shot(drive, linear + self.distorted(linear) + self.noise * self._draw(linear.shape), noise)

    def distorted(self, linear: np.ndarray) -> np.ndarray:
        """Return overtones of third order of the part of the strong lines that is as wanted."""
        wanted = self._wanted[self._strong]
        part = np.vdot(wanted, linear[self._strong]) / np.vdot(wanted, wanted)
        overtones: np.ndarray = self._distortion * part**3
        return overtones

    def _draw(self, shape: tuple[int, ...]) -> np.ndarray:
        return np.sqrt(0.5) * (self._rng.standard_normal(shape) + 1j * self._rng.standard_normal(shape))
