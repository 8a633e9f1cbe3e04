"""The program's own frequency-domain laws on plain arrays: any number of drives and sensors, in any units."""

from collections.abc import Sequence

import numpy as np

from vibractl.config import Adaptation, Learning, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.decision import Decision
from vibractl.learning.gains import Gains
from vibractl.learning.kinds_of_law import KINDS
from vibractl.learning.law import Law, bounded_inverse
from vibractl.learning.laws import Plant
from vibractl.learning.shot import Shot
from vibractl.transfer_matrix import TransferMatrix

FAINTEST = 1e-12
"""Of the largest line's power, that is taken for noise where none is told."""


class FrequencyDomainILC:
    """Learns the drive by which a repeatable plant emits a reference, line by line of the trial's spectrum.

    Lines are those of the whole trial's FFT; what is said of volts and accelerations elsewhere holds in any units.
    Arrays of one drive and one sensor may be given, and are returned, without their last axes.

    Parameters
    ----------
    response : complex array, shape (lines, sensors, drives), or (lines,)
        G, as measured.
    variance : array, as `response`, optional
        E |G_hat - G|^2; a ten-thousandth of its power without.
    reference : complex array, shape (lines, sensors), or (lines,), optional
        What is to come; to be given to the first `step` where it is not given here.
    frequency : array, shape (lines,), optional
        Of the lines, rising; their numbers without.  By it modes that move are told apart.
    epsilon : float, 1
        Of the bounded inverse, re the size of G at each line.
    gains : sequence of float, optional
        Of the updates, in stages of `stages` trials each but for the last; as the law's own without.
    stages : sequence of int
    objective_db : float, dB
        Error that is allowed, re the reference's level: no more is dared below it.

    Attributes
    ----------
    drive : complex array, shape (lines, drives), or (lines,)
        To be tried next.
    decisions : list of Decision
        Of the last step: what was held, gone back to, and why.

    Raises
    ------
    ValueError : shapes that do not fit, or a value that is not finite.
    """

    law = "kalman"

    def __init__(
        self,
        response: np.ndarray,
        variance: np.ndarray | None = None,
        reference: np.ndarray | None = None,
        *,
        frequency: np.ndarray | None = None,
        epsilon: float = 1e-3,
        gains: Sequence[float] = (),
        stages: Sequence[int] = (),
        objective_db: float = -40.0,
    ) -> None:
        self._is_single = np.ndim(response) == 1
        matrix = np.asarray(response, complex)
        matrix = matrix[:, None, None] if self._is_single else matrix
        given = 1e-4 * np.abs(matrix) ** 2 if variance is None else np.asarray(variance, float).reshape(matrix.shape)
        at = np.arange(1.0, len(matrix) + 1.0) if frequency is None else np.asarray(frequency, float)
        self._model = TransferMatrix(at, matrix, given, np.ones(matrix.shape))
        self._settings = Learning(
            law=self.law, epsilon=epsilon, gains=tuple(gains), stages=tuple(stages), regularisation="per-line"
        )
        self._objective = objective_db
        self._algorithm: Algorithm | None = None
        if reference is not None:
            self._begin(reference)

    @property
    def drive(self) -> np.ndarray:
        """Return what is to be tried next, shape (lines, drives), or (lines,)."""
        return self._told(self._made().lines)

    @property
    def response(self) -> np.ndarray:
        """Return G as it is believed now, shape (lines, sensors, drives), or (lines,)."""
        found = self._model.response if self._algorithm is None else self._algorithm.belief.response
        return found[:, 0, 0] if self._is_single else found

    @property
    def variance(self) -> np.ndarray:
        """Return E |G_hat - G|^2 as it is believed now, as `response`."""
        found = self._model.variance if self._algorithm is None else self._algorithm.belief.variance
        return found[:, 0, 0] if self._is_single else found

    @property
    def decisions(self) -> list[Decision]:
        """Return what the last step has decided."""
        return [] if self._algorithm is None else list(self._algorithm.decisions)

    def step(
        self,
        drive: np.ndarray,
        measured: np.ndarray,
        reference: np.ndarray | None = None,
        noise: np.ndarray | float | None = None,
    ) -> np.ndarray:
        """Return the drive of the next trial, shape (lines, drives), or (lines,).

        Parameters
        ----------
        drive : complex array, shape (lines, drives), or (lines,)
            That this trial was made with; it need not be the one that was asked for.
        measured : complex array, shape (lines, sensors), or (lines,)
            What came.
        reference : complex array, as `measured`, optional
            In the first step, where it was not given before.
        noise : array, as `measured`, or float, optional
            E |N|^2 in what was measured; hardly any without.
        """
        if reference is not None and self._algorithm is None:
            self._begin(reference)
        algorithm = self._made()
        played, came = self._lines(drive, 2, "drive"), self._lines(measured, 1, "measured")
        if noise is None:
            power = np.full(came.shape, FAINTEST * float(np.abs(algorithm.law.reference).max() ** 2))
        else:
            power = np.array(np.broadcast_to(np.reshape(noise, (-1, 1)) if self._is_single else noise, came.shape))
        algorithm.step(Shot(played, came, power.astype(float)))
        return self._told(algorithm.lines)

    def _made(self) -> Algorithm:
        if self._algorithm is None:
            raise ValueError("reference is not given: it belongs to the law, or to its first step")
        return self._algorithm

    def _begin(self, reference: np.ndarray) -> None:
        wanted, model, settings = self._lines(reference, 1, "reference"), self._model, self._settings
        if not np.abs(wanted).max() > 0:
            raise ValueError("reference is zero on every bin, must be something to emit")
        inverse, kind = bounded_inverse(model.response, settings), KINDS[self.law]
        start = kind.law.first(Plant(model.response, inverse, wanted))
        gains = Gains(settings.gains, settings.stages) if settings.gains else kind.gains
        outputs = tuple(range(model.outputs))
        law = Law(model, inverse, settings, wanted, start, gains, np.ones(len(wanted)), outputs, np.eye(model.inputs))
        self._algorithm = Algorithm(law, Adaptation(), Watch(on=False), self._objective)

    def _lines(self, given: np.ndarray, axis: int, name: str) -> np.ndarray:
        found = np.asarray(given, complex)
        found = found[:, None] if self._is_single and found.ndim == 1 else found
        wanted = (len(self._model.frequency), self._model.response.shape[axis])
        if found.shape != wanted:
            raise ValueError(f"{name} has shape {np.shape(given)}, must be {wanted[:1] if self._is_single else wanted}")
        if not np.isfinite(found).all():
            raise ValueError(f"{name} is not finite on bin {int(np.argwhere(~np.isfinite(found))[0][0])}")
        return found

    def _told(self, lines: np.ndarray) -> np.ndarray:
        return lines[:, 0].copy() if self._is_single else lines.copy()


class KalmanILC(FrequencyDomainILC):
    """The program's own law: it follows G from trial to trial by a Kalman filter, and dares what that promises.

    Parameters: those of `FrequencyDomainILC`.

    Examples
    --------
    >>> lines = np.arange(1.0, 40.0)
    >>> plant = 1.0 / (1.0 + 0.1j * lines)
    >>> wanted = np.exp(-0.5 * ((lines - 15) / 6) ** 2).astype(complex)
    >>> law = KalmanILC(1.5 * plant, 0.3 * np.abs(plant) ** 2, wanted)  # a model half too large
    >>> for _ in range(6):
    ...     measured = plant * law.drive
    ...     _ = law.step(law.drive, measured)
    >>> bool(np.abs(wanted - plant * law.drive).max() < 1e-2)
    True
    """


class ThesisILC(FrequencyDomainILC):
    """U <- U + K G^+ E with the model as it was measured, from the scaled reference.

    Parameters: those of `FrequencyDomainILC`.

    Source
    ------
    Sornmo 2015, eqs. (6.9)-(6.19) and Algorithm 1.
    """

    law = "thesis"
