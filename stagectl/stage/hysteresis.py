"""A piezo actuator's hysteresis: the generalized Prandtl-Ishlinskii model, what it answers, and its inverse."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stagectl.stage import hysteresis_kernel as kernel


@dataclass(frozen=True)
class HysteresisModel:
    """Response of an actuator to its voltage, with loops.

    With x from -1 to 1 over the range of voltage,

    w = c0 + c1 x + c2 x^2 + c3 x^3 + sum of weight z,  z = max(rise(x) - r, min(fall(x) + r, z before)),

    rise(x) = x + a2 x^2 + a3 x^3 and fall alike; then the response lags behind w with a time constant, and comes
    `delay` samples late.  Two envelopes make loops that are wider at one end than at the other.

    Every part rises with x, so that the whole can be inverted.  Arrays are copied and cannot be written to afterwards.

    Parameters
    ----------
    low, high : float, V
        The range of voltage it holds for; beyond, the nearer end counts.
    cubic : array, shape (4,), m
        c0 to c3.
    rising, falling : arrays, shape (2,), 1
        a2 and a3 of the envelope that holds as the voltage rises, and as it falls.
    thresholds : array, shape (plays,), 1, >= 0
    weights : array, shape (plays,), m, >= 0
    rate : float, samples/s, > 0
        At which lag and delay are counted.
    lag : float, s, >= 0
        Makes loops wider the quicker they are run through; 0 for a model that knows no rate.
    delay : int, samples, >= 0
    provenance : mapping of strings, optional
        From which recording, configuration and commit it came.

    Raises
    ------
    ValueError : sizes that do not fit, a value that is not finite or out of range, a part that does not rise with x.

    Source
    ------
    Al Janaideh, Rakheja and Su, Mechatronics 19 (2009) 656, and as Sörnmo 2015, sec. 2.3 names it.

    Departs
    -------
    Envelopes are cubic, not tanh: with the cubic beside the plays they are linear in their parameters, and the stack
    saturates but a little.  Inversion is by a monotone equation for each sample instead of the inverse play operators,
    which exist only where both envelopes are one.
    """

    low: float
    high: float
    cubic: np.ndarray
    rising: np.ndarray
    falling: np.ndarray
    thresholds: np.ndarray
    weights: np.ndarray
    rate: float
    lag: float = 0.0
    delay: int = 0
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse a model that is not one, or has no inverse."""
        for name, size in (("cubic", 4), ("rising", 2), ("falling", 2), ("thresholds", None), ("weights", None)):
            values = np.array(getattr(self, name), dtype=float)
            if values.ndim != 1 or (size is not None and len(values) != size) or not np.all(np.isfinite(values)):
                raise ValueError(f"{name} is {values}, must be {size or 'one or more'} finite numbers")
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        if not (np.isfinite(self.low) and np.isfinite(self.high) and self.low < self.high):
            raise ValueError(f"low is {self.low} and high {self.high} V, must be finite and low < high")
        if len(self.thresholds) != len(self.weights):
            raise ValueError(f"{len(self.thresholds)} thresholds and {len(self.weights)} weights, must be as many")
        for name in ("thresholds", "weights"):
            if not np.all(getattr(self, name) >= 0):
                raise ValueError(f"{name} has {getattr(self, name).min()}, must be >= 0")
        if not (np.isfinite(self.rate) and self.rate > 0 and np.isfinite(self.lag) and self.lag >= 0):
            raise ValueError(f"rate is {self.rate} samples/s and lag {self.lag} s, must be > 0 and >= 0")
        if isinstance(self.delay, bool) or not isinstance(self.delay, int) or self.delay < 0:
            raise ValueError(f"delay is {self.delay!r} samples, must be a whole number >= 0")
        self._refuse_falling_parts()

    @property
    def span(self) -> tuple[float, float]:
        """Response at the lowest and at the highest voltage, where all plays have moved, m."""
        ends = respond(self.without_dynamics(), np.array([self.low, self.high, self.low, self.high]), start=self.low)
        return float(ends[2]), float(ends[3])

    @property
    def shape(self) -> np.ndarray:
        """The kernel's parameters beside the plays, shape (SHAPE,)."""
        return np.concatenate([[self.low, self.high], self.cubic, self.rising, self.falling])

    @property
    def plays(self) -> np.ndarray:
        """Thresholds (1) and weights (m), shape (plays, 2)."""
        return np.column_stack([self.thresholds, self.weights])

    def without_dynamics(self) -> "HysteresisModel":
        """Return the same loops without lag and delay."""
        parts = (self.cubic, self.rising, self.falling, self.thresholds, self.weights)
        return HysteresisModel(self.low, self.high, *parts, self.rate, provenance=self.provenance)

    def _refuse_falling_parts(self) -> None:
        x = np.linspace(-1, 1, 2001)
        for name, curve in (("rising", self.rising), ("falling", self.falling)):
            slope = 1 + x * (2 * curve[0] + 3 * curve[1] * x)
            if not slope.min() >= 0:
                raise ValueError(f"{name} envelope {curve} has slope {slope.min():.3g} at x = {x[slope.argmin()]:.2g}")
        slope = self.cubic[1] + x * (2 * self.cubic[2] + 3 * self.cubic[3] * x)
        whole = self.cubic[1] + self.weights.sum()
        if not slope.min() > 1e-6 * whole:
            raise ValueError(
                f"cubic {self.cubic} has slope {slope.min():.3g} m at x = {x[slope.argmin()]:.2g}, must be > "
                f"{1e-6 * whole:.3g} for an inverse"
            )


def respond(model: HysteresisModel, voltage: np.ndarray, start: float | None = None) -> np.ndarray:
    """Return what an actuator does under a voltage.

    Parameters
    ----------
    model : HysteresisModel
    voltage : array, shape (samples,), V
    start : float, optional, V
        About which cycles have died away before the first sample; that of the first sample where not given.

    Returns
    -------
    array, shape (samples,), m

    Examples
    --------
    >>> model = HysteresisModel(0.0, 100.0, [0, 1e-6, 0, 0], [0, 0], [0, 0], [0.5], [1e-6], 100.0)
    >>> respond(model, np.array([50.0, 100.0, 50.0, 0.0])) * 1e6
    array([ 0. ,  1.5,  0.5, -1.5])
    """
    voltage = _samples("voltage", voltage)
    memory = _memory(model, voltage[0] if start is None else start)
    response = np.empty_like(voltage)
    kernel.respond(voltage, response, model.shape, model.plays, memory)
    if model.lag > 0:
        kernel.lag(response, _pole(model))
    return np.concatenate([np.full(model.delay, response[0]), response])[: len(voltage)]


def invert(model: HysteresisModel, response: np.ndarray, start: float | None = None) -> np.ndarray:
    """Return the voltage under which an actuator does what is wanted, `delay` samples later.

    Exact, but where the response is beyond the actuator's reach: there the voltage stays at the end of its range.  The
    lag is undone by a lead, the delay is left to whoever knows the future.

    Parameters
    ----------
    model : HysteresisModel
    response : array, shape (samples,), m
        What is wanted.
    start : float, optional, V
        About which cycles have died away before the first sample; mid-range where not given.

    Returns
    -------
    array, shape (samples,), V
    """
    wanted = _samples("response", response)
    if model.lag > 0:
        pole = _pole(model)
        wanted = np.concatenate([wanted[:1], (wanted[1:] - pole * wanted[:-1]) / (1 - pole)])
    memory = _memory(model, 0.5 * (model.low + model.high) if start is None else start)
    voltage = np.empty_like(wanted)
    kernel.invert(wanted, voltage, model.shape, model.plays, memory)
    return voltage


def _pole(model: HysteresisModel) -> float:
    return float(np.exp(-1 / (model.rate * model.lag)))


def _memory(model: HysteresisModel, start: float) -> np.ndarray:
    memory = np.empty(len(model.thresholds) + 1)
    kernel.reset(start, model.shape, memory)
    return memory


def _samples(name: str, values: np.ndarray) -> np.ndarray:
    values = np.ascontiguousarray(values, dtype=float)
    if values.ndim != 1 or not len(values) or not np.all(np.isfinite(values)):
        raise ValueError(f"{name} has shape {values.shape}, must be one or more finite samples, shape (samples,)")
    return values
