"""The inner loop's PID: its parameters, its coefficients at a rate, and a design that keeps it robust."""

import math
from dataclasses import dataclass

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.config import Inner
from stagectl.stage.sensitivity import Robustness, robustness
from stagectl.stage.state_space import StateSpace, plant_of

_STEP = 0.9
LEAST_MARGIN = 3.0
"""Factor on the gain that a designed loop bears: hysteresis lets a stack move twice as far with a large voltage as with
the small one that it was identified with."""
_TRIES = 40


@dataclass(frozen=True)
class Pid:
    """A PID with filtered derivative and tracking anti-windup.

    Parameters
    ----------
    proportional : float, V/m
    integral : float, V/(m s)
    derivative : float, V s/m
    smoothing : float, s, > 0
        Time constant of the derivative's low-pass.
    tracking : float, s, > 0
        Time constant with which the integral follows a voltage that is limited.
    feedforward : float, V/m
        From the reference straight to the voltage.

    Source
    ------
    Sörnmo 2015, eq. (2.2); anti-windup by tracking, and feedforward from the reference: Åström and Hägglund, Advanced
    PID Control, 2005, sections 3.5 and 5.3.
    """

    proportional: float
    integral: float
    derivative: float
    smoothing: float
    tracking: float
    feedforward: float = 0.0

    def coefficients(self, rate: float) -> dict[str, float]:
        """Return the fields of an `AXIS` record at `rate` samples/s; the derivative is a backward difference."""
        pole = self.smoothing * rate / (1.0 + self.smoothing * rate)
        return {
            "proportional": self.proportional,
            "integration": self.integral / rate,
            "tracking": min(1.0, 1.0 / (self.tracking * rate)),
            "derivative": self.derivative * (1.0 - pole) * rate,
            "derivative_pole": pole,
            "direct": self.feedforward,
        }

    def system(self, rate: float) -> StateSpace:
        """Return it as a system from the error (m) to the voltage (V), without limits and feedforward."""
        now = self.coefficients(rate)
        pole, gain = now["derivative_pole"], now["derivative"]
        return StateSpace(
            np.array([[1.0, 0.0, 0.0], [0.0, pole, -gain], [0.0, 0.0, 0.0]]),
            np.array([[now["integration"]], [gain], [1.0]]),
            np.array([[1.0, pole, -gain]]),
            np.array([[now["proportional"] + gain]]),
        )


def pid(inner: Inner, axis: int) -> Pid:
    """Return the PID that a rig file asks for on an axis, counted from 0."""
    gain = inner.gain[axis % len(inner.gain)]
    return _of_gain(gain, inner.bandwidth[axis % len(inner.bandwidth)], inner)


def robust_pid(model: InnovationModel, inner: Inner, axis: int, max_sensitivity: float) -> tuple[Pid, Robustness]:
    """Design the PID on a model: its integral part as fast as the rig file asks for, or slower until it is robust.

    Parameters
    ----------
    model : InnovationModel
        One voltage (V) in, one extension (m) out.
    inner : Inner
        Its `gain` gives way to the model's own at rest.
    axis : int, counted from 0
    max_sensitivity : float, 1
        Bound on Ms, with one sample of delay more than the model's; the gain margin is `LEAST_MARGIN` or more.

    Returns
    -------
    Pid, Robustness

    Raises
    ------
    ValueError : the model has other inputs or outputs, or no gain at rest, or the bound cannot be met.
    """
    plant, gain = plant_of(model), gain_at_rest(model)
    wanted = inner.bandwidth[axis % len(inner.bandwidth)]
    for attempt in range(_TRIES):
        designed = _of_gain(gain, wanted * _STEP**attempt, inner)
        figures = robustness(plant, designed.system(model.rate), model.rate, delay=1)
        if figures.stable and figures.max_sensitivity <= max_sensitivity and figures.gain_margins[1] >= LEAST_MARGIN:
            return designed, figures
    raise ValueError(
        f"no PID of {wanted * _STEP ** (_TRIES - 1):.3g} to {wanted:g} Hz with inner.proportional "
        f"{inner.proportional:g} and inner.lead {inner.lead:g} s keeps Ms <= {max_sensitivity:g} on the model from "
        f"voltage to extension, whose gain at rest is {gain:.3g} m/V"
    )


def gain_at_rest(model: InnovationModel) -> float:
    """Return what a volt stretches a stack by, m/V; ValueError if that is not > 0."""
    gain = float(plant_of(model).response(np.zeros(1), model.rate)[0].real)
    if not (math.isfinite(gain) and gain > 0):
        raise ValueError(f"the model's gain at rest is {gain:g} m/V, must be > 0")
    return gain


def _of_gain(gain: float, bandwidth: float, inner: Inner) -> Pid:
    return Pid(
        inner.proportional / gain,
        2.0 * math.pi * bandwidth / gain,
        inner.lead / gain,
        inner.smoothing,
        inner.tracking,
        inner.feedforward / gain,
    )
