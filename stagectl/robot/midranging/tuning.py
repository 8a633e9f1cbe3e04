"""Models of position loops, and lambda tuning of PI controllers from them."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from stagectl.robot.midranging.axis_record import ORDER
from stagectl.robot.midranging.loop_model_kernel import GAIN, RADIUS, is_usable


@dataclass(frozen=True)
class LoopModel:
    """A position loop: y_k = sum a_i y_{k-i} + sum b_i w_{k-i}, i from 1 to the order.

    Parameters
    ----------
    outputs, inputs : tuple of float, 1
        a_i and b_i, one to three of each.

    Raises
    ------
    ValueError : as many as there are not, or a loop that is unstable, or whose gain at rest is far from one.
    """

    outputs: tuple[float, ...]
    inputs: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse what is no position loop."""
        if not 1 <= len(self.outputs) == len(self.inputs) <= ORDER:
            raise ValueError(f"there are {len(self.outputs)} a and {len(self.inputs)} b, must be 1 to {ORDER} of each")
        if not is_usable(self.parameters, self.order):
            raise ValueError(
                f"the model has a {self.outputs} and b {self.inputs}: its poles must lie within {RADIUS} of the origin "
                f"and its gain at rest within {GAIN[0]} to {GAIN[1]}"
            )

    @classmethod
    def first_order(cls, time_constant: float, rate: float) -> Self:
        """Return the loop of gain one with this time constant (s, > 0), sampled with a held input at `rate`."""
        if not 0.0 < time_constant < math.inf:
            raise ValueError(f"the time constant is {time_constant} s, must be finite and > 0")
        pole = math.exp(-1.0 / (time_constant * rate))
        return cls((pole,), (1.0 - pole,))

    @property
    def order(self) -> int:
        """How many a and b there are."""
        return len(self.outputs)

    @property
    def parameters(self) -> np.ndarray:
        """The a and then the b, shape (2 order,), 1."""
        return np.array([*self.outputs, *self.inputs])

    def of_order(self, order: int) -> "LoopModel":
        """Return the same loop written with more parameters, the further ones zero."""
        if not self.order <= order <= ORDER:
            raise ValueError(f"order is {order}, must be {self.order} to {ORDER}")
        more = (0.0,) * (order - self.order)
        return LoopModel(self.outputs + more, self.inputs + more)

    def with_process_gain(self, gain: float) -> "LoopModel":
        """Return the loop with the same controller around a process of `gain` (1, > 0) times the gain.

        Source
        ------
        Sörnmo 2015, eq. (3.12): the open loop is H_cl / (1 - H_cl).
        """
        inputs = tuple(gain * b for b in self.inputs)
        return LoopModel(tuple(a + b - c for a, b, c in zip(self.outputs, self.inputs, inputs, strict=True)), inputs)

    def time_constant(self, rate: float) -> float:
        """Return the time constant of the loop reduced to first order, s: of the same area above its step response."""
        rest = 1.0 - sum(self.outputs)
        late = sum(n * a for n, a in enumerate(self.outputs, start=1)) / rest
        late += sum(n * b for n, b in enumerate(self.inputs, start=1)) / sum(self.inputs)
        if not late > 1.0:
            raise ValueError(f"the model is {late:g} samples late, must be more than one to be of first order")
        return -1.0 / (rate * math.log1p(-1.0 / late))


@dataclass(frozen=True)
class Pi:
    """A PI controller: gain (1) and integral rate (1/s)."""

    gain: float
    rate: float


def lambda_tuned(time_constant: float, closed: float) -> Pi:
    """Tune a PI controller for a process of first order and gain one.

    Parameters
    ----------
    time_constant : float, s
        Of the process.
    closed : float, s
        Of the closed loop: lambda.

    Raises
    ------
    ValueError : one of them is not finite and > 0.

    Source
    ------
    Sörnmo 2015, sections 2.3 and 3.2, after Allison and Ogawa 2003: the zero cancels the process' pole.
    """
    for name, value in (("time_constant", time_constant), ("closed", closed)):
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} is {value} s, must be finite and > 0")
    return Pi(time_constant / closed, 1.0 / closed)


def integral(closed: float) -> Pi:
    """Return a controller that only integrates, at a rate of 1 / `closed` (s): the valve position controller proper."""
    return Pi(0.0, lambda_tuned(closed, closed).rate)
