"""A mid-ranging controller simulated against two loops given as plain arrays."""

from dataclasses import dataclass

import numpy as np

from stagectl.robot.midranging.array_loop import Stepped, System, coefficients
from stagectl.robot.midranging.of_arrays import Controller


@dataclass(frozen=True)
class Run:
    """A simulated run, from the reference's first sample on; arrays of shape (samples,), in the reference's unit.

    Parameters
    ----------
    time : array, s
    reference, position : array
        The relative position as wanted, and itself.
    fast, slow : array
        Positions of both manipulators, without noise.
    fast_reference, slow_reference : array
        What they were asked for.
    control : array, unit/s
        The fast loop's inner control signal, ahead of its saturation.
    """

    time: np.ndarray
    reference: np.ndarray
    position: np.ndarray
    fast: np.ndarray
    slow: np.ndarray
    fast_reference: np.ndarray
    slow_reference: np.ndarray
    control: np.ndarray

    @property
    def iae(self) -> float:
        """Integrated absolute error of the relative position, unit s [Sörnmo 2015, eq. (3.15)]."""
        return float(np.abs(self.reference - self.position).sum() * (self.time[1] - self.time[0]))


def simulate(
    controller: Controller,
    fast: System,
    slow: System,
    reference: np.ndarray,
    disturbance: np.ndarray | None = None,
    *,
    noise: float = 0.0,
    seed: int = 1,
) -> Run:
    """Simulate a controller, from its beginning, against loops that need not be those it was designed from.

    Parameters
    ----------
    controller : Controller
        It is reset first, and its longest estimation phase comes before the reference.
    fast, slow : (numerator, denominator) in falling powers of z, or (A, B, C) or (A, B, C, D)
        Of any order.  The fast loop's inner process follows from it and the inner controller by (3.12), so that its
        control signal saturates at the controller's `limit`.
    reference : array, shape (samples,), length
    disturbance : array, shape (samples,), length; optional
        Of the relative position, any unit; 0 without.
    noise : float
        Standard deviation of each of the three positions' sensors, white.
    seed : int
        Of the noise.

    Raises
    ------
    ValueError : a loop that is none, or signals of differing lengths.

    Source
    ------
    Sörnmo 2015, figure 3.2 and eq. (3.12).
    """
    wanted = np.asarray(reference, float)
    outside = np.zeros(len(wanted)) if disturbance is None else np.asarray(disturbance, float)
    if wanted.shape != (len(wanted),) or outside.shape != wanted.shape:
        raise ValueError(f"reference is {wanted.shape}, disturbance {outside.shape}, must be (samples,) both")
    lead = int(np.ceil(controller.lead * controller.rate))
    wanted, outside = np.pad(wanted, (lead, 0)), np.pad(outside, (lead, 0))
    seen = noise * np.random.default_rng(seed).standard_normal((len(wanted), 3))
    controller.reset()
    quick, late = _Saturating(controller, fast), Stepped(*coefficients(slow))
    told = np.zeros((len(wanted), 6))
    control = 0.0
    for n, (want, apart) in enumerate(zip(wanted, outside, strict=True)):
        shown, place = quick.place, late.free
        whole = shown + place + apart
        relative, near, far = np.array([whole, shown, place]) + seen[n]
        asked = controller.step(want, relative, near, far, control)
        control = quick.step(asked.fast)
        late.step(asked.slow)
        told[n] = whole, shown, place, asked.fast, asked.slow, control
    signals = told[lead:].T.copy()
    time = np.arange(signals.shape[1]) / controller.rate
    return Run(time, wanted[lead:], *(signals[row] for row in range(len(signals))))


class _Saturating:
    """A fast loop whose inner control signal saturates: its inner controller, and the process that follows."""

    def __init__(self, controller: Controller, system: System) -> None:
        b, a = coefficients(system)
        governor = controller.governor
        self._limit = governor.limit
        self._inner = Stepped(np.array(governor.numerator), np.array(governor.denominator))
        self._process = Stepped(np.convolve(governor.denominator, b), np.convolve(governor.numerator, a - b))

    @property
    def place(self) -> float:
        """The position now."""
        return self._process.free

    def step(self, asked: float) -> float:
        """Take what is asked for now; return the control signal ahead of its saturation."""
        control = self._inner.step(asked - self.place)
        self._process.step(min(max(control, -self._limit), self._limit))
        return control
