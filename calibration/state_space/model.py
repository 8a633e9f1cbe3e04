"""The innovation-form state space (2.1): the record that calibration writes and controllers read."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from calibration.state_space import model_kernel
from calibration.state_space.model_checks import MATRICES, check_matrices, check_words
from calibration.state_space.modes import Modes, modes
from calibration.state_space.state_fit import fit_state


@dataclass(frozen=True)
class InnovationModel:
    """A sampled linear system with m inputs, p outputs and n states, driven by inputs u and white innovations e.

    x[k+1] = A x[k] + B u[k] + K e[k],  y[k] = C x[k] + D u[k] + e[k].

    Arrays are copied on the way in and cannot be written to afterwards.  n = 0 is a static gain.

    Parameters
    ----------
    A : array, shape (n, n), 1
    B : array, shape (n, m), 1 per the inputs' units
    C : array, shape (p, n), the outputs' units
    D : array, shape (p, m), the outputs' per the inputs' units
    K : array, shape (n, p), 1 per the outputs' units
        Kalman gain; zero for a model of the response alone, with white noise on its outputs.
    rate : float, samples/s, > 0
    innovation : array, shape (p, p), products of the outputs' units
        Covariance of e, symmetric and positive semidefinite.
    input_names, output_names : tuples of strings, optional
        u1, u2 ... and y1, y2 ... where not given.
    input_units, output_units : tuples of strings, optional
        1 where not given.
    provenance : mapping of strings, optional
        From which recording, configuration and commit it came.

    Raises
    ------
    ValueError : sizes that do not fit together, a value that is not finite, a name missing or given twice.

    Source
    ------
    Sörnmo 2015, eq. (2.1).

    Departs
    -------
    D: a stage measured through its anti-alias filter may answer within the sample.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    K: np.ndarray
    rate: float
    innovation: np.ndarray
    input_names: tuple[str, ...] = ()
    output_names: tuple[str, ...] = ()
    input_units: tuple[str, ...] = ()
    output_units: tuple[str, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse a model that is not one."""
        parts = {name: np.array(getattr(self, name), dtype=float, order="C") for name in MATRICES}
        check_matrices(parts)
        for name, matrix in parts.items():
            matrix.setflags(write=False)
            object.__setattr__(self, name, matrix)
        if not (np.isfinite(self.rate) and self.rate > 0):
            raise ValueError(f"rate is {self.rate}, must be > 0 samples/s")
        for side, letter, count in (("input", "u", self.inputs), ("output", "y", self.outputs)):
            names = tuple(getattr(self, f"{side}_names")) or tuple(f"{letter}{k + 1}" for k in range(count))
            units = tuple(getattr(self, f"{side}_units")) or ("1",) * count
            check_words(side, names, units, count)
            object.__setattr__(self, f"{side}_names", names)
            object.__setattr__(self, f"{side}_units", units)

    @property
    def order(self) -> int:
        """States."""
        return int(self.A.shape[0])

    @property
    def inputs(self) -> int:
        """Inputs."""
        return int(self.B.shape[1])

    @property
    def outputs(self) -> int:
        """Outputs."""
        return int(self.C.shape[0])

    @property
    def poles(self) -> np.ndarray:
        """Discrete poles, the eigenvalues of A: complex, shape (n,)."""
        poles: np.ndarray = np.linalg.eigvals(self.A).astype(complex)
        return poles

    @property
    def modes(self) -> Modes:
        """Natural frequencies (Hz) and damping ratios, by rising frequency."""
        return modes(self.poles, self.rate)

    @property
    def is_stable(self) -> bool:
        """Whether every free response decays."""
        return bool(np.all(np.abs(self.poles) < 1))

    def simulate(self, drive: ArrayLike, state: np.ndarray | None = None) -> np.ndarray:
        """Return the free run: the response to a drive alone, without innovations.

        Parameters
        ----------
        drive : array, shape (N, m), (N,) of one, the inputs' units
        state : array, shape (n,), 1, optional
            At the first sample; zero where not given.

        Returns
        -------
        array, shape (N, p), the outputs' units
        """
        drive = self._signal("drive", drive, self.inputs)
        response = np.empty((len(drive), self.outputs))
        a, b, c, d = (matrix.T.copy() for matrix in (self.A, self.B, self.C, self.D))
        model_kernel.free_run(a, b, c, d, drive, self._state(state), response)
        return response

    def predict(self, drive: ArrayLike | None, response: ArrayLike, state: np.ndarray | None = None) -> np.ndarray:
        """Return each sample as predicted from those before it, and from the drive up to it: one step ahead.

        Parameters
        ----------
        drive : array, shape (N, m), (N,) of one, the inputs' units; None where there are none
        response : array, shape (N, p), the outputs' units
            As measured.
        state : array, shape (n,), 1, optional
            At the first sample; zero where not given.

        Returns
        -------
        array, shape (N, p), the outputs' units
        """
        drive, response = self._signals(drive, response)
        predicted = np.empty_like(response)
        a, b, c, d, k = (matrix.T.copy() for matrix in (self.A, self.B, self.C, self.D, self.K))
        model_kernel.one_step_ahead((a, b, c, d, k), drive, response, self._state(state), predicted)
        return predicted

    def initial_state(self, drive: ArrayLike | None, response: ArrayLike) -> np.ndarray:
        """Return the state, shape (n,), from which the free run fits a measured response best, by least squares.

        Each output counts in units of its innovation's standard deviation.

        Parameters
        ----------
        drive : array, shape (N, m), (N,) of one, the inputs' units; None where there are none
        response : array, shape (N, p), the outputs' units
        """
        drive, response = self._signals(drive, response)
        return self._fitted_state(self.A, response - self.simulate(drive))

    def initial_predictor_state(self, drive: ArrayLike | None, response: ArrayLike) -> np.ndarray:
        """Return the state, shape (n,), from which the prediction one step ahead fits best, by least squares.

        Each output counts in units of its innovation's standard deviation.

        Parameters
        ----------
        drive : array, shape (N, m), (N,) of one, the inputs' units; None where there are none
        response : array, shape (N, p), the outputs' units
        """
        drive, response = self._signals(drive, response)
        return self._fitted_state(self.A - self.K @ self.C, response - self.predict(drive, response))

    def frequency_response(self, frequency: np.ndarray) -> np.ndarray:
        """Return the response from inputs to outputs, complex, shape (bins, p, m), the outputs' per the inputs' units.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        """
        return np.asarray(self._driven(self.B, frequency) + self.D)

    def spectrum(self, frequency: np.ndarray) -> np.ndarray:
        """Return the one-sided power spectral density of what comes of the innovations alone.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
            From 0 to half the rate.

        Returns
        -------
        array, shape (bins, p, p), products of the outputs' units per Hz

        Source
        ------
        Ljung 1999, System Identification, 2nd ed., eq. (4.26): H Lambda H*.
        """
        coloured = self._driven(self.K, frequency) + np.eye(self.outputs)
        return np.asarray(2 / self.rate * coloured @ self.innovation @ coloured.conj().transpose(0, 2, 1))

    def described(self, **words: str) -> "InnovationModel":
        """Return it with more words in its provenance."""
        return replace(self, provenance={**self.provenance, **words})

    def _driven(self, inlet: np.ndarray, frequency: np.ndarray) -> np.ndarray:
        """Return C (z I - A)^-1 inlet at frequencies, Hz: shape (bins, p, columns)."""
        turn = np.exp(2j * np.pi * np.asarray(frequency, float) / self.rate)
        shifted = turn[:, None, None] * np.eye(self.order) - self.A
        states = np.linalg.solve(shifted, np.broadcast_to(inlet, (len(turn), *inlet.shape)))
        return np.asarray(self.C @ states)

    def _fitted_state(self, transition: np.ndarray, missed: np.ndarray) -> np.ndarray:
        size = np.sqrt(np.maximum(np.diag(self.innovation), 0.0))
        size = size if np.all(size > 0) else np.ones(self.outputs)
        return fit_state(transition, self.C / size[:, None], missed / size)

    def _state(self, state: np.ndarray | None) -> np.ndarray:
        if state is None:
            return np.zeros(self.order)
        if np.shape(state) != (self.order,):
            raise ValueError(f"state has shape {np.shape(state)}, must be ({self.order},)")
        return np.array(state, dtype=float)

    def _signal(self, name: str, signal: ArrayLike, width: int) -> np.ndarray:
        array = np.array(signal, dtype=float, order="C")
        if array.ndim == 1 and width == 1:
            return array[:, None]
        if array.ndim != 2 or array.shape[1] != width:
            raise ValueError(f"{name} has shape {array.shape}, must be (N, {width}){' or (N,)' * (width == 1)}")
        return array

    def _signals(self, drive: ArrayLike | None, response: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        heard = self._signal("response", response, self.outputs)
        if drive is None and self.inputs:
            raise ValueError(f"drive is None, must be (N, {self.inputs}): the model has inputs")
        pushed = self._signal("drive", np.zeros((len(heard), 0)) if drive is None else drive, self.inputs)
        if len(pushed) != len(heard):
            raise ValueError(f"drive has {len(pushed)} samples and response {len(heard)}, must be as many")
        return pushed, heard
