"""A measured transfer matrix with its uncertainty, its bounded inverse, and how fast learning with it contracts."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

GAPS = "gaps"
"""Word of a model's provenance."""
SIDE = 0.25
"""Hz beyond the ends of a gap that belong to it."""


@dataclass(frozen=True)
class TransferMatrix:
    """Frequency response from coils to accelerometers on a rising, not always even, grid.

    Parameters
    ----------
    frequency : array, shape (bins,), Hz, rising
    response : complex array, shape (bins, outputs, inputs), m/s^2 per V
    variance : array, shape (bins, outputs, inputs), (m/s^2 per V)^2
        Of the complex estimate: E |G_hat - G|^2.
    coherence : array, shape (bins, outputs, inputs), 0 to 1
        Part of the response's power at the line that the drive explains.
    provenance : mapping of strings
        From which rig, recording, configuration and commit it came; `rig` is compared before use.

    Raises
    ------
    ValueError : shapes disagree, the grid does not rise, or a value is not finite.
    """

    frequency: np.ndarray
    response: np.ndarray
    variance: np.ndarray
    coherence: np.ndarray
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse a matrix that is not one."""
        shape = self.response.shape
        if self.frequency.ndim != 1 or len(shape) != 3 or shape[0] != len(self.frequency) or len(self.frequency) < 4:
            raise ValueError(
                f"response has shape {shape} over {self.frequency.shape} frequencies, "
                "must be (bins, outputs, inputs) over (bins,), at least 4 bins"
            )
        if not np.all(np.diff(self.frequency) > 0):
            raise ValueError("the frequencies of a transfer matrix must rise")
        for name in ("response", "variance", "coherence"):
            value = getattr(self, name)
            if value.shape != shape:
                raise ValueError(f"{name} has shape {value.shape}, must be {shape}")
            if not np.isfinite(value).all():
                bad = self.frequency[np.argwhere(~np.isfinite(value))[0][0]]
                raise ValueError(f"{name} is not finite at {bad:g} Hz")
        _ = self.gaps

    @property
    def outputs(self) -> int:
        """Accelerometers."""
        count: int = self.response.shape[1]
        return count

    @property
    def inputs(self) -> int:
        """Coils."""
        count: int = self.response.shape[2]
        return count

    @property
    def gaps(self) -> list[tuple[float, float, str]]:
        """Bands without values: first and last line, Hz, and why; none, but in models from recordings of others."""
        text = self.provenance.get(GAPS, "[]")
        try:
            return [(float(low), float(high), str(reason)) for low, high, reason in json.loads(text)]
        except (ValueError, TypeError, RecursionError):
            raise ValueError(f"{GAPS} is {text[:60]!r}, must be a list of first and last Hz and a reason") from None

    def lacks(self, frequency: np.ndarray) -> np.ndarray:
        """Say which lines lie in a gap, (lines,) of bool.

        Parameters
        ----------
        frequency : array, shape (lines,), Hz
        """
        inside = np.zeros(len(frequency), bool)
        for low, high, _ in self.gaps:
            inside |= (frequency > low - SIDE) & (frequency < high + SIDE)
        return inside

    def covers(self, frequency: np.ndarray) -> np.ndarray:
        """Say at which lines there is a value, (lines,) of bool: within the band, and in no gap.

        Parameters
        ----------
        frequency : array, shape (lines,), Hz
        """
        within = (frequency >= self.frequency[0]) & (frequency <= self.frequency[-1])
        covered: np.ndarray = within & ~self.lacks(frequency)
        return covered

    def described(self, **words: str) -> "TransferMatrix":
        """Return it with more words in its provenance."""
        return replace(self, provenance={**self.provenance, **words})

    def at(self, frequency: np.ndarray) -> "TransferMatrix":
        """Interpolate to other lines: modified Akima on real and imaginary part, linear on variance and coherence.

        Parameters
        ----------
        frequency : array, shape (lines,), Hz

        Raises
        ------
        ValueError : a line outside the measured band, or in a gap in it.
        """
        low, high = self.frequency[0], self.frequency[-1]
        if len(frequency) and not (frequency.min() >= low and frequency.max() <= high):
            raise ValueError(
                f"bins {frequency.min():g} to {frequency.max():g} Hz are wanted, the model was measured "
                f"from {low:g} to {high:g} Hz"
            )
        if self.lacks(frequency).any():
            first, last, reason = next(
                gap for gap in self.gaps if ((frequency > gap[0] - SIDE) & (frequency < gap[1] + SIDE)).any()
            )
            raise ValueError(
                f"bins {frequency.min():g} to {frequency.max():g} Hz are wanted, the model has no value from "
                f"{first:g} to {last:g} Hz: {reason}"
            )
        from scipy.interpolate import Akima1DInterpolator  # noqa: PLC0415 (not needed where lines are given)

        parts = np.stack([self.response.real, self.response.imag], axis=-1)
        parts = Akima1DInterpolator(self.frequency, parts, method="makima")(frequency)
        place = np.interp(frequency, self.frequency, np.arange(len(self.frequency)))
        below = np.minimum(place.astype(int), len(self.frequency) - 2)
        share = (place - below)[:, None, None]
        variance, coherence = (
            value[below] * (1 - share) + value[below + 1] * share for value in (self.variance, self.coherence)
        )
        response = parts[..., 0] + 1j * parts[..., 1]
        return TransferMatrix(frequency, response, variance, coherence, self.provenance)


def norm(matrix: np.ndarray) -> np.ndarray:
    """Return the largest singular value of each matrix of a stack.

    Parameters
    ----------
    matrix : complex array, shape (bins, rows, columns), any unit

    Returns
    -------
    array, shape (bins,)
    """
    size: np.ndarray = np.linalg.norm(matrix, 2, axis=(-2, -1))
    return size


def regularized_inverse(response: np.ndarray, epsilon: np.ndarray | float) -> np.ndarray:
    """Invert a transfer matrix bin by bin, staying bounded where it is near singular.

    Parameters
    ----------
    response : complex array, shape (bins, outputs, inputs), m/s^2 per V
    epsilon : array, shape (bins,), or float, (m/s^2 per V)^2
        Tikhonov weight, > 0.  Larger is safer and learns slower near notches.

    Returns
    -------
    complex array, shape (bins, inputs, outputs), V per m/s^2

    Source
    ------
    Sörnmo 2015, eq. (6.19).

    Departs
    -------
    Conjugate transpose for the transpose of the text: `response` is complex.

    Examples
    --------
    >>> regularized_inverse(np.array([[[2j]]]), 0.0)
    array([[[0.-0.5j]]])
    """
    adjoint = response.conj().swapaxes(-1, -2)
    weight = np.broadcast_to(np.asarray(epsilon, dtype=float), response.shape[:1])
    square = adjoint @ response + weight[:, None, None] * np.eye(response.shape[-1])
    inverse: np.ndarray = np.linalg.solve(square, adjoint)
    return inverse


def line_weights(response: np.ndarray, epsilon: float, floor: float) -> np.ndarray:
    """Weigh each line by its own size: eps_f = epsilon ||G_f||^2 + floor max ||G||^2.

    A constant eps that is safe near the notches makes all weak lines crawl; this one works over more than a decade.

    Parameters
    ----------
    response : complex array, shape (bins, outputs, inputs), m/s^2 per V
    epsilon, floor : float, 1, >= 0

    Returns
    -------
    array, shape (bins,), (m/s^2 per V)^2
    """
    square = norm(response) ** 2
    weight: np.ndarray = epsilon * square + floor * square.max()
    return weight


def contraction(
    response: np.ndarray,
    variance: np.ndarray,
    inverse: np.ndarray,
    gain: np.ndarray | float,
    deviations: float = 2.0,
) -> np.ndarray:
    """Bound by how much one update shrinks the error at each line; learning is certified where it is below one.

    || I - G G^+ K || <= || I - G_hat G^+ K || + K || dG || || G^+ ||, with || dG || bounded by `deviations` standard
    deviations of the estimate in the Frobenius norm.

    Parameters
    ----------
    response : complex array, shape (lines, outputs, inputs), m/s^2 per V
    variance : array, shape (lines, outputs, inputs), (m/s^2 per V)^2
        E |G_hat - G|^2.
    inverse : complex array, shape (lines, inputs, outputs), V per m/s^2
    gain : array, shape (lines,), or float, 1
        K of (6.11).
    deviations : float, 1, >= 0; 0 gives the estimate's own value

    Returns
    -------
    array, shape (lines,)

    Source
    ------
    Sörnmo 2015, eq. (6.12), (6.18).
    """
    pace = np.broadcast_to(np.asarray(gain, dtype=float), response.shape[:1])
    nominal = norm(np.eye(response.shape[1]) - pace[:, None, None] * (response @ inverse))
    doubt = np.sqrt(variance.sum(axis=(-2, -1)))
    bound: np.ndarray = nominal + pace * deviations * doubt * norm(inverse)
    return bound
