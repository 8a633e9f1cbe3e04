"""What was identified of a frequency response: state-space matrices, modes with errors, confidence bands."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from calibration.frequency_domain.modal_form import ModalForm
from calibration.state_space.conversion import control_package
from rigkit.model_file import ModelFile, read_model_file, write_model_file

FORMAT = "vibrostage.response-model/1"
_PARTS = ("decay", "turn", "B", "C", "D")
_RANK = 1e-10
"""Directions in which the numbers of a form are known less well than this part of the best are its own freedom."""


@dataclass(frozen=True, eq=False)
class ResponseModel:
    """A state-space model of a frequency response, in continuous time or at a rate.

    Parameters
    ----------
    form : ModalForm
        In continuous time, s in units of `scale`; with a rate, that s is (2 / T) (z - 1) / (z + 1).
    scale : float, rad/s
    rate : float or None, samples/s
        None: continuous.
    covariance : array, shape (count, count), 1
        Of the form's numbers.
    spread : float, 1
        What is left, over what the variances let expect: root of chi-square over degrees of freedom.
    band : (float, float), Hz
        That it was fitted to.
    """

    form: ModalForm
    scale: float
    rate: float | None
    covariance: np.ndarray
    spread: float
    band: tuple[float, float]

    @property
    def order(self) -> int:
        """Number of states."""
        return self.form.order

    @cached_property
    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """A, B, C and D: of dx/dt = A x + B u in continuous time, of x[k + 1] = A x[k] + B u[k] at a rate."""
        form = self.form
        continuous = self.scale * form.A, self.scale * form.B, form.C, form.D
        if self.rate is None:
            return continuous
        from scipy.signal import cont2discrete

        a, b, c, d, _ = cont2discrete(continuous, 1 / self.rate, "bilinear")
        return a, b, c, d

    def response(self, frequency: np.ndarray) -> np.ndarray:
        """Return the frequency response, shape (bins, outputs, inputs).

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        """
        found: np.ndarray = self.form.response(points_of(frequency, self.scale, self.rate))
        return found

    def errors(self, frequency: np.ndarray) -> np.ndarray:
        """Return the standard errors of the response, root of E |error|^2, shape (bins, outputs, inputs).

        By the covariance of the model's numbers: they hold where the order is right.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        """
        _, by = self.form.slopes(points_of(frequency, self.scale, self.rate))
        variance = np.einsum("kaic,cd,kaid->kai", by.conj(), self.covariance, by, optimize=True).real
        errors: np.ndarray = np.sqrt(np.maximum(variance, 0.0))
        return errors

    def poles(self) -> np.ndarray:
        """Return the modes, with standard errors.

        Returns
        -------
        structured array, shape (modes,)
            Fields `frequency` and `frequency_error` (Hz), `damping` and `damping_error` (1), by rising frequency.  At
            a rate they are those of s = rate ln z, with z a pole of A.
        """
        form, pairs = self.form, len(self.form.turn)
        poles, slope = _continuous(self.scale * form.poles, self.rate)
        count = len(poles)
        moved = np.zeros((count, len(self.covariance)), complex)  # by each of the form's numbers
        at, own = np.arange(count), np.arange(pairs)
        moved[at, at] = -slope * self.scale * form.decay
        moved[own, count + own] = 1j * slope[:pairs] * self.scale * np.sign(form.turn)
        size = np.abs(poles)
        damping = -poles.real / size
        by_size = (poles.conj()[:, np.newaxis] * moved).real / size[:, np.newaxis]
        by_damping = -(moved.real + damping[:, np.newaxis] * by_size) / size[:, np.newaxis]
        spread = [np.sqrt(np.einsum("ic,cd,id->i", by, self.covariance, by)) for by in (by_size, by_damping)]
        columns = (size / (2 * np.pi), spread[0] / (2 * np.pi), damping, spread[1])
        names = ("frequency", "frequency_error", "damping", "damping_error")
        found = np.array(list(zip(*columns, strict=True)), dtype=[(name, float) for name in names])
        return np.sort(found, order="frequency")

    def to_scipy(self) -> Any:
        """Return a `scipy.signal.StateSpace`, continuous or discrete."""
        from scipy.signal import StateSpace

        return StateSpace(*self.matrices, **({} if self.rate is None else {"dt": 1 / self.rate}))

    def to_control(self) -> Any:
        """Return a `control.StateSpace`, continuous or discrete; python-control must be installed."""
        return control_package().ss(*self.matrices, 0 if self.rate is None else 1 / self.rate)

    def save(self, path: str | Path, **provenance: str) -> Path:
        """Write it as an HDF5 model file, which `read_response_model` takes; return where it is."""
        arrays = {name: getattr(self.form, name) for name in _PARTS}
        a, b, c, d = self.matrices
        arrays |= {"covariance": self.covariance, "state_A": a, "state_B": b, "state_C": c, "state_D": d}
        numbers = (self.scale, self.rate or 0.0, self.spread, *self.band)
        arrays["numbers"] = np.array(numbers)
        write_model_file(Path(path), ModelFile(FORMAT, arrays, provenance=provenance))
        return Path(path)

    @property
    def told(self) -> str:
        """It in a few words."""
        time = "continuous" if self.rate is None else f"{self.rate:g} samples/s"
        outputs, inputs = self.form.D.shape
        low, high = self.band
        return f"{self.order} states, {inputs} to {outputs}, {time}, {low:g} to {high:g} Hz"

    def summary(self) -> str:
        """Return order, band and modes with their standard errors, in lines of text."""
        kind = [("frequency, Hz", "+-"), ("damping ratio", "+-")]
        rows = ["  ".join(f"{name:>13}  {error:>9}" for name, error in kind)]
        for mode in self.poles():
            pairs = [(mode[name], mode[f"{name}_error"]) for name in ("frequency", "damping")]
            rows.append("  ".join(f"{value:13.5g}  {error:9.2g}" for value, error in pairs))
        return "\n".join([self.told, f"what is left, over what the variances let expect: {self.spread:.3g}", *rows])

    def __repr__(self) -> str:
        """Return a line."""
        return f"<ResponseModel: {self.told}>"


def read_response_model(path: Path) -> ResponseModel:
    """Read what `ResponseModel.save` has written.

    Raises
    ------
    ModelFileError : no such file, or another kind of file, or a damaged one.
    """
    content = read_model_file(path, FORMAT, [*_PARTS, "covariance", "numbers"])
    arrays = content.arrays
    scale, rate, spread, low, high = (float(value) for value in arrays["numbers"])
    form = ModalForm(*(arrays[name] for name in _PARTS))
    return ResponseModel(form, scale, rate or None, arrays["covariance"], spread, (low, high))


def points_of(frequency: np.ndarray, scale: float, rate: float | None) -> np.ndarray:
    """Return where frequencies lie on the imaginary axis of the form's s: shape (bins,), complex, in units of `scale`.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz
    scale : float, rad/s
    rate : float or None, samples/s
    """
    omega = 2 * np.pi * np.asarray(frequency, float)
    points: np.ndarray = 1j * (omega if rate is None else 2 * rate * np.tan(omega / (2 * rate))) / scale
    return points


def covariance_of(normal: np.ndarray, spread: float) -> np.ndarray:
    """Return the covariance of a form's numbers from J^T J, on what the response tells of them alone.

    The response does not change when the states of a mode are scaled or turned: along these directions nothing is
    known, and nothing that is asked of the model depends on them.

    Parameters
    ----------
    normal : array, shape (count, count), 1
    spread : float, 1
        By which errors are larger than those that it was made with.
    """
    covariance: np.ndarray = spread**2 * np.linalg.pinv(normal, rcond=_RANK, hermitian=True)
    return covariance


def _continuous(poles: np.ndarray, rate: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Return the poles in continuous time, rad/s, of which a form's are the bilinear image at a rate, and the slope.

    Those at a rate are s = rate ln z with z = (1 + w / 2 rate) / (1 - w / 2 rate).
    """
    if rate is None:
        return poles, np.ones(len(poles))
    turned = poles / (2 * rate)
    return rate * np.log((1 + turned) / (1 - turned)), 1 / (1 - turned**2)
