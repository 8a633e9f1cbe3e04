"""Laws that are linear from trial to trial, u <- Q (u + L e), on lines of a spectrum or on samples in lifted form."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class LinearILC:
    """u <- Q (u + L e).

    Over a spectrum its matrices have a line in front: shape (lines, inputs, outputs); in lifted form there is none, and
    a row a sample: (samples, samples).

    Parameters
    ----------
    learning : array, shape (..., inputs, outputs)
        L, unit of the drive per unit of the error.
    robustness : array, shape (..., inputs, inputs), or float
        Q, 1.

    Raises
    ------
    ValueError : shapes that do not fit.

    Source
    ------
    Bristow, Tharayil and Alleyne, A survey of iterative learning control, 2006, eq. (3).
    """

    learning: np.ndarray
    robustness: np.ndarray | float = 1.0

    def __post_init__(self) -> None:
        """Refuse matrices that do not fit."""
        inputs, keep = np.shape(self.learning)[-2:][0], np.shape(self.robustness)
        if np.ndim(self.learning) < 2 or (keep and keep[-2:] != (inputs, inputs)):
            raise ValueError(
                f"learning has shape {np.shape(self.learning)} and robustness {keep}, must be (..., inputs, outputs) "
                "and (..., inputs, inputs), or a number"
            )

    def step(self, drive: np.ndarray, error: np.ndarray) -> np.ndarray:
        """Return the next drive, shape (..., inputs).

        Parameters
        ----------
        drive : array, shape (..., inputs), any unit
            Of this trial.
        error : array, shape (..., outputs), any unit
            Reference less what came.
        """
        learned = drive + (self.learning @ error[..., None])[..., 0]
        if np.ndim(self.robustness) == 0:
            return np.asarray(self.robustness * learned)
        return np.asarray((self.robustness @ learned[..., None])[..., 0])


def lifted(impulse_response: np.ndarray, samples: int) -> np.ndarray:
    """Return the matrix G of y = G u over a trial that begins at rest, shape (samples, samples).

    Parameters
    ----------
    impulse_response : array, shape (taps,), any unit
        From its first sample that is not zero by a delay on: element n is what sample n answers to one at 0.
    samples : int
        Of a trial.

    Examples
    --------
    >>> lifted(np.array([0.0, 2.0, 1.0]), 3)
    array([[0., 0., 0.],
           [2., 0., 0.],
           [1., 2., 0.]])
    """
    taps = np.zeros(samples)
    count = min(samples, len(impulse_response))
    taps[:count] = impulse_response[:count]
    late = np.arange(samples)[:, None] - np.arange(samples)
    return np.where(late >= 0, taps[np.maximum(late, 0)], 0.0)


def norm_optimal(plant: np.ndarray, error: float = 1.0, drive: float = 0.0, change: float = 0.0) -> LinearILC:
    """Return the law that makes ||e||^2 Q + ||u||^2 R + ||u - u_k||^2 S smallest in each trial, by a model.

    Parameters
    ----------
    plant : array, shape (..., outputs, inputs), any unit
        G.
    error, drive, change : float, >= 0
        Q, R and S: weights of the error, of the drive, and of its change.

    Raises
    ------
    ValueError : a weight below 0, or none that makes the drive unique.

    Source
    ------
    Gunnarsson and Norrlof, On the design of ILC algorithms using optimization, 2001, eq. (12).
    """
    for name, weight in (("error", error), ("drive", drive), ("change", change)):
        if not weight >= 0.0:
            raise ValueError(f"{name} is {weight!r}, must be >= 0")
    adjoint = np.conj(np.swapaxes(plant, -1, -2))
    inner, own = error * adjoint @ plant, np.eye(plant.shape[-1])
    try:
        solved = np.linalg.inv(inner + (drive + change) * own)
    except np.linalg.LinAlgError:
        raise ValueError("the plant has drives without a response: drive or change must be > 0") from None
    return LinearILC(
        np.linalg.pinv(inner + change * own, hermitian=True) @ (error * adjoint), solved @ (inner + change * own)
    )


def p_type(gain: float, samples: int, lead: int = 1) -> LinearILC:
    """Return the law u(n) <- u(n) + gain e(n + lead), in lifted form.

    Parameters
    ----------
    gain : float, unit of the drive per unit of the error
    samples : int
        Of a trial.
    lead : int, >= 0
        The plant's delay, samples.

    Source
    ------
    Arimoto, Kawamura and Miyazaki, Bettering operation of robots by learning, 1984.
    """
    if not 0 <= lead < samples:
        raise ValueError(f"lead is {lead}, must be 0 to {samples - 1}")
    return LinearILC(gain * np.eye(samples, k=lead))


def with_low_pass(learning: np.ndarray, frequency: np.ndarray, passed: Callable[[np.ndarray], np.ndarray]) -> LinearILC:
    """Return a law over a spectrum whose Q passes without phase what a function of frequency says.

    Parameters
    ----------
    learning : array, shape (lines, inputs, outputs), any unit
        L.
    frequency : array, shape (lines,), Hz
    passed : callable(array) -> array
        From frequencies to gains, 0 to 1.
    """
    keep = np.asarray(passed(frequency), float)
    return LinearILC(learning, keep[:, None, None] * np.eye(np.shape(learning)[-2]))


@dataclass(frozen=True, eq=False)
class Convergence:
    """What becomes of a law on a plant, from trial to trial.

    Parameters
    ----------
    radius : array, shape (...,), 1
        Spectral radius of Q (I - L G): below 1 the drive comes to a limit.
    norm : array, shape (...,), 1
        Its largest singular value: below 1 it comes nearer to it in each trial.
    left : array, shape (..., outputs, outputs), 1
        What is left of a reference in the limit: e = `left` r.
    """

    radius: np.ndarray
    norm: np.ndarray
    left: np.ndarray

    @property
    def converges(self) -> bool:
        """Whether the drive comes to a limit, on each line."""
        return bool((self.radius < 1.0).all())

    @property
    def is_monotone(self) -> bool:
        """Whether it comes nearer to it in each trial, on each line."""
        return bool((self.norm < 1.0).all())


def convergence(law: LinearILC, plant: np.ndarray) -> Convergence:
    """Say what becomes of a law on a plant, which need not be the one that it was made for.

    Parameters
    ----------
    law : LinearILC
    plant : array, shape (..., outputs, inputs), any unit
        G as it is.

    Source
    ------
    Bristow, Tharayil and Alleyne, 2006, theorems 1 and 3, and eq. (10).
    """
    own = np.eye(plant.shape[-1])
    keep = law.robustness * own if np.ndim(law.robustness) == 0 else np.asarray(law.robustness)
    step = keep @ (own - law.learning @ plant)
    radius = np.abs(np.linalg.eigvals(step)).max(axis=-1)
    norm = np.linalg.norm(step, 2, axis=(-2, -1))
    limit = plant @ np.linalg.pinv(own - step) @ keep @ law.learning
    return Convergence(np.asarray(radius), np.asarray(norm), np.eye(plant.shape[-2]) - limit)
