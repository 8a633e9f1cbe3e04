"""The dynamic reference governor: what the fast loop may be asked for, so that nothing in it saturates."""

import math
from dataclasses import dataclass

import numpy as np

from stagectl.robot.midranging.axis_record import GOVERNOR, ORDER
from stagectl.robot.midranging.tuning import LoopModel


@dataclass(frozen=True)
class Governor:
    """The limits of one axis' fast loop, and its inner controller.

    Parameters
    ----------
    numerator, denominator : tuple of float, m/s per m and 1
        Of the inner controller (3.6), in powers of z^-1; up to three beyond the direct term.
    limit : float, m/s, > 0
        u_sat of the inner control signal.
    travel : float, m, > 0
        How far the position may be from its middle, to either side; infinite for no limit.
    lookahead : float, s, >= 0
        How far the position is foreseen for that: past the overshoot of the fast loop.

    Raises
    ------
    ValueError : a value outside its range; a controller without a direct term, or with one of negative gain.
    """

    numerator: tuple[float, ...]
    denominator: tuple[float, ...] = (1.0,)
    limit: float = math.inf
    travel: float = math.inf
    lookahead: float = 0.4

    def __post_init__(self) -> None:
        """Refuse what cannot be."""
        for name in ("numerator", "denominator"):
            terms = getattr(self, name)
            if not (1 <= len(terms) <= ORDER + 1 and all(map(math.isfinite, terms))):
                raise ValueError(f"{name} is {terms}, must be 1 to {ORDER + 1} finite numbers")
        if not self.numerator[0] * self.denominator[0] > 0.0:
            raise ValueError(
                f"the inner controller has {self.numerator[0]} over {self.denominator[0]} as its direct term, "
                "must be > 0: the governor acts through it"
            )
        for name, unit in (("limit", "m/s"), ("travel", "m")):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} is {getattr(self, name)} {unit}, must be > 0")
        if not 0.0 <= self.lookahead < math.inf:
            raise ValueError(f"lookahead is {self.lookahead} s, must be finite and >= 0")

    @property
    def direct(self) -> float:
        """What an error puts into the control signal at once, m/s per m."""
        return self.numerator[0] / self.denominator[0]

    def packed(self, rate: float) -> np.void:
        """Return the governor as the kernel reads it, at rest, at `rate` samples/s."""
        record: np.void = np.zeros(1, GOVERNOR)[0]
        record["numerator"][: len(self.numerator)] = self.numerator
        record["denominator"][: len(self.denominator)] = self.denominator
        record["limit"], record["travel"] = self.limit, self.travel
        record["trust"] = 1.0
        record["horizon"] = round(self.lookahead * rate) if math.isfinite(self.travel) else 0
        return record


def control_response(governor: Governor, fast: LoopModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the polynomials of (3.9): how the reference of the fast loop makes its inner control signal.

    Parameters
    ----------
    governor : Governor
    fast : LoopModel
        H_cl^f, known or estimated.

    Returns
    -------
    arrays, shape (coefficients,), m/s per m and 1
        q and p, in powers of z^-1.

    Source
    ------
    Sörnmo 2015, eqs. (3.9) and (3.12): u = H_c (1 - H_cl) w, so that the process itself is never formed.
    """
    outputs = np.array([1.0, *(-each for each in fast.outputs)])
    inputs = np.array([0.0, *fast.inputs])
    q = np.convolve(governor.numerator, outputs - inputs)
    p = np.convolve(governor.denominator, outputs)
    return q, p


def process_response(governor: Governor, fast: LoopModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the inner process H_o^f = H_cl / (H_c (1 - H_cl)), which the fast loop's model implies.

    Parameters
    ----------
    governor : Governor
    fast : LoopModel
        H_cl^f, known or estimated.

    Returns
    -------
    arrays, shape (coefficients,), m per m/s and 1
        Numerator and denominator, in powers of z^-1.

    Source
    ------
    Sörnmo 2015, eq. (3.12).
    """
    inputs = np.array([0.0, *fast.inputs])
    outputs = np.array([1.0, *(-each for each in fast.outputs)])
    numerator = np.convolve(governor.denominator, inputs)
    denominator = np.convolve(governor.numerator, outputs - inputs)
    return numerator, denominator
