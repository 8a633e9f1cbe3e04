"""Laws that are linear from trial to trial, u <- Q (u + L e), on lines of a spectrum or on samples in lifted form."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rigkit.discrete_system import arrays_of, impulse_response, is_system


@dataclass(frozen=True, eq=False, repr=False)
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
        shape, keep = np.shape(self.learning), np.shape(self.robustness)
        if len(shape) < 2 or (keep and keep[-2:] != (shape[-2], shape[-2])):
            raise ValueError(
                f"learning has shape {shape} and robustness {keep}, must be (..., inputs, outputs) "
                "and (..., inputs, inputs), or a number"
            )

    def __repr__(self) -> str:
        """Return a line."""
        return f"<LinearILC: L of shape {np.shape(self.learning)}, Q of shape {np.shape(self.robustness)}>"

    def step(self, drive: np.ndarray, error: np.ndarray) -> np.ndarray:
        """Return the next drive, shape (..., inputs).

        Parameters
        ----------
        drive : array, shape (..., inputs), any unit
            Of this trial.
        error : array, shape (..., outputs), any unit
            Reference less what came.

        Raises
        ------
        ValueError : shapes that do not fit.
        """
        inputs, outputs = np.shape(self.learning)[-2:]
        if np.shape(drive)[-1:] != (inputs,) or np.shape(error)[-1:] != (outputs,):
            raise ValueError(
                f"drive has shape {np.shape(drive)} and error {np.shape(error)}, must end in {inputs} and {outputs}"
            )
        learned = drive + (self.learning @ error[..., None])[..., 0]
        if np.ndim(self.robustness) == 0:
            return np.asarray(self.robustness * learned)
        return np.asarray((self.robustness @ learned[..., None])[..., 0])


def lifted(plant: Any, samples: int, lead: int = 0) -> np.ndarray:
    """Return the matrix G of y = G u over a trial that begins at rest, shape (samples, samples).

    Parameters
    ----------
    plant : array, shape (taps,), any unit; tuple of arrays; scipy.signal.dlti; or a discrete system of python-control
        Its impulse response, dead time included: element n is what sample n answers to a one at sample 0.  A tuple is
        (numerator, denominator) in falling powers of z, or (A, B, C), or (A, B, C, D).
    samples : int
        Of a trial.
    lead : int, samples
        The plant's dead time, where it is to be left out: row n is then sample n + lead of the response, and every
        sample of the drive has an answer.

    Raises
    ------
    ValueError : several inputs or outputs, a continuous system, another shape, values that are not finite.

    Examples
    --------
    >>> lifted(np.array([0.0, 2.0, 1.0]), 3)
    array([[0., 0., 0.],
           [2., 0., 0.],
           [1., 2., 0.]])
    >>> lifted(([2.0, 1.0], [1.0, 0.0, 0.0]), 2, lead=1)
    array([[2., 0.],
           [1., 2.]])
    """
    for name, value, least in (("samples", samples, 1), ("lead", lead, 0)):
        if not isinstance(value, int | np.integer) or value < least:
            raise ValueError(f"{name} is {value!r}, must be a whole number >= {least}")
    given = arrays_of(plant) if is_system(plant) else plant
    answer = impulse_response(given, samples + lead) if isinstance(given, tuple) else np.asarray(given, float)
    if answer.ndim != 1:
        raise ValueError(f"the impulse response has shape {answer.shape}, must be (taps,)")
    if not np.isfinite(answer).all():
        raise ValueError(f"the impulse response is not finite at sample {int(np.argmin(np.isfinite(answer)))}")
    taps = np.zeros(samples)
    kept = answer[lead : samples + lead]
    taps[: len(kept)] = kept
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
    ValueError : a weight below 0, or none that makes the drive unique; a plant that is no matrix.

    Source
    ------
    Gunnarsson and Norrlof, On the design of ILC algorithms using optimization, 2001, eq. (12).
    """
    for name, weight in (("error", error), ("drive", drive), ("change", change)):
        if not weight >= 0.0:
            raise ValueError(f"{name} is {weight!r}, must be >= 0")
    plant = _matrix(plant)
    adjoint = np.conj(np.swapaxes(plant, -1, -2))
    inner, own = error * adjoint @ plant, np.eye(plant.shape[-1])
    try:
        solved = np.linalg.inv(inner + (drive + change) * own)
    except np.linalg.LinAlgError:
        raise ValueError(
            "the plant has drives without a response: drive or change must be > 0, or its dead time left out by "
            "lifted(..., lead=SAMPLES)"
        ) from None
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
        The plant's dead time, samples; 0 on a plant that was lifted without it.

    Raises
    ------
    ValueError : a lead that the trial does not have.

    Source
    ------
    Arimoto, Kawamura and Miyazaki, Bettering operation of robots by learning, 1984.
    """
    if not isinstance(samples, int | np.integer) or not 0 <= lead < samples:
        raise ValueError(f"lead is {lead} and samples {samples}, must be whole numbers with 0 <= lead < samples")
    return LinearILC(gain * np.eye(samples, k=lead))


def with_low_pass(learning: np.ndarray, frequency: np.ndarray, passed: Callable[[np.ndarray], np.ndarray]) -> LinearILC:
    """Return a law over a spectrum whose Q passes without phase what a function of frequency says.

    Parameters
    ----------
    learning : array, shape (lines, inputs, outputs), any unit
        L; a law's own is `law.learning`.
    frequency : array, shape (lines,), Hz
    passed : callable(array) -> array
        From frequencies to gains, 0 to 1.

    Raises
    ------
    ValueError : shapes that do not fit.
    """
    keep = np.asarray(passed(frequency), float)
    if np.ndim(learning) != 3 or keep.shape != (len(learning),):
        raise ValueError(
            f"learning has shape {np.shape(learning)} and what passes {keep.shape}, must be (lines, inputs, outputs) "
            "and (lines,): in lifted form Q is a matrix of yours, LinearILC(learning, robustness)"
        )
    return LinearILC(learning, keep[:, None, None] * np.eye(np.shape(learning)[-2]))


@dataclass(frozen=True, eq=False, repr=False)
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

    def __repr__(self) -> str:
        """Return a line, of the worst line of a spectrum."""
        said = f"radius {self.radius.max():.7g}, largest singular value {self.norm.max():.7g}"
        verdict = "converges" if self.converges else "does not converge"
        return f"<Convergence: {said}; {verdict}{', monotone' if self.is_monotone else ''}>"

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

    In lifted form the last samples of a drive have no answer within the trial where the plant has dead time.  A law
    that leaves them as they are has a radius of 1 for them alone: leave the dead time out, by `lead` of `lifted`.

    Parameters
    ----------
    law : LinearILC
    plant : array, shape (..., outputs, inputs), any unit
        G as it is.

    Raises
    ------
    ValueError : another kind of law, a plant that is no matrix, or shapes that do not fit.

    Source
    ------
    Bristow, Tharayil and Alleyne, 2006, theorems 1 and 3, and eq. (10).
    """
    if not isinstance(law, LinearILC):
        raise ValueError(f"law is a {type(law).__name__}, must be a LinearILC, with matrices L and Q")
    plant, (inputs, outputs) = _matrix(plant), np.shape(law.learning)[-2:]
    if plant.shape[-2:] != (outputs, inputs):
        raise ValueError(
            f"plant has shape {plant.shape} and the law's L {np.shape(law.learning)}, must be (..., outputs, inputs) "
            "and (..., inputs, outputs)"
        )
    own = np.eye(plant.shape[-1])
    keep = law.robustness * own if np.ndim(law.robustness) == 0 else np.asarray(law.robustness)
    step = keep @ (own - law.learning @ plant)
    radius = np.abs(np.linalg.eigvals(step)).max(axis=-1)
    norm = np.linalg.norm(step, 2, axis=(-2, -1))
    limit = plant @ np.linalg.pinv(own - step) @ keep @ law.learning
    return Convergence(np.asarray(radius), np.asarray(norm), np.eye(plant.shape[-2]) - limit)


def _matrix(plant: Any) -> np.ndarray:
    if is_system(plant) or np.ndim(plant) < 2:
        what = f"is a {type(plant).__name__}" if is_system(plant) else f"has shape {np.shape(plant)}"
        raise ValueError(f"plant {what}, must be (..., outputs, inputs): lifted(plant, samples) makes that matrix")
    return np.asarray(plant)
