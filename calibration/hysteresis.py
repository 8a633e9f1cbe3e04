"""Fit of a generalized Prandtl-Ishlinskii model to a voltage and what it moved: convex inside, a simplex outside."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, nnls

from stagectl.stage import hysteresis_kernel as kernel
from stagectl.stage.hysteresis import HysteresisModel, respond

PLAYS = 16
"""Thresholds are spread evenly over the half of the voltage's range; the fit leaves many a weight at zero."""
STEEPEST_ENVELOPE = 0.95
"""|2 a2| + |3 a3| <= this keeps both envelopes rising."""
LEAST_SLOPE = 1e-3
"""Of the straight line's: the cubic beside the plays is at least so steep, which is what the inverse divides by."""
LONGEST_LAG = 0.2
"""s."""
SMALL_WEIGHTS = 3e-6
"""What a squared weight costs beside the mean squared misfit, both of the response's variance.  It keeps out plays that
move so little that only a weight of many spans makes them count; in the fit itself it costs less than 0.1 % of rms."""
STILL = 1e-9
"""1: a play that moves less than this over the fitted samples is left out."""
SIMPLEX_STEPS, SIMPLEX_SIZE = 600, 0.1
SEARCHED = 3000
"""Samples, evenly from those to fit, that the simplex looks at; weights are then fitted to all."""


@dataclass(frozen=True)
class HysteresisFit:
    """A fitted model and the record it was fitted to.

    Parameters
    ----------
    model : HysteresisModel
    modelled : array, shape (samples,), m
        Its response to the whole record's voltage.
    fitted : slice
        The samples it was fitted to.
    """

    model: HysteresisModel
    modelled: np.ndarray
    fitted: slice


@dataclass(frozen=True)
class Settings:
    """What is fitted.

    Parameters
    ----------
    plays : int, >= 1
    delay : int, samples, >= 0
        Of the response.
    with_lag : bool
        Whether a lag is fitted; a record of one frequency cannot tell it from loops of another shape.
    """

    plays: int = PLAYS
    delay: int = 1
    with_lag: bool = False

    def __post_init__(self) -> None:
        """Refuse what cannot be fitted."""
        if not 1 <= self.plays <= 200:
            raise ValueError(f"plays is {self.plays}, must be 1 to 200")
        if not 0 <= self.delay <= 1000:
            raise ValueError(f"delay is {self.delay} samples, must be 0 to 1000")


def fit(
    voltage: np.ndarray,
    response: np.ndarray,
    rate: float,
    fitted: slice | None = None,
    settings: Settings | None = None,
) -> HysteresisFit:
    """Fit a model to a part of a record, from the record's first sample on.

    For given envelopes and lag the response is linear in the weights of the plays and in a cubic that rises over the
    range, all >= 0: a convex problem, solved exactly.  The four coefficients of the envelopes, and the lag, are found
    around it by a simplex.

    Parameters
    ----------
    voltage : array, shape (samples,), V
        Its range becomes the model's.
    response : array, shape (samples,), m
    rate : float, samples/s
    fitted : slice, optional
        The samples to fit; all where not given.  Those before move the plays, but do not count.
    settings : Settings, optional

    Returns
    -------
    HysteresisFit

    Source
    ------
    Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, for taking linear parameters out; Lawson and Hanson, Solving
    Least Squares Problems, 1974, ch. 23, for weights that are not negative.

    Raises
    ------
    ValueError : records that do not fit together, are not finite, too short, or do not move.
    """
    settings, fitted = settings or Settings(), fitted or slice(None)
    voltage, response = np.ascontiguousarray(voltage, dtype=float), np.ascontiguousarray(response, dtype=float)
    _refuse_unfit(voltage, response, rate, fitted, settings)
    problem = _Problem(voltage, response, rate, fitted, settings)
    outer = _simplex(problem, np.zeros(4))
    outer = _simplex(problem, np.append(outer, 0.0) if settings.with_lag else outer)
    model = problem.model(outer)
    return HysteresisFit(model, respond(model, voltage), fitted)


class _Problem:
    """The least squares that is left once envelopes and lag are given."""

    def __init__(
        self, voltage: np.ndarray, response: np.ndarray, rate: float, fitted: slice, settings: Settings
    ) -> None:
        self._voltage, self._rate, self._fitted, self._settings = voltage, rate, fitted, settings
        self._range = float(voltage.min()), float(voltage.max())
        x = 2 * (voltage - self._range[0]) / (self._range[1] - self._range[0]) - 1
        # integrals of the quadratic Bernstein polynomials, the first of slope 1 at x = -1, the last at x = 1
        self._cubics = np.array([x - x**2 + x**3 / 3, 2 * (x - x**3 / 3), x + x**2 + x**3 / 3]) / 4
        self._mean, self._scale = float(response[fitted].mean()), float(np.std(response[fitted]))
        self._wanted = (response - self._mean) / self._scale
        self._all = np.arange(len(voltage))[fitted]
        self._some = self._all[:: -(-len(self._all) // SEARCHED)]
        self._thresholds = np.arange(settings.plays) / settings.plays + 0.5 / settings.plays

    def residual(self, outer: np.ndarray) -> float:
        """Return the rms left over, of the response's own; large where an envelope would not rise."""
        if not self._is_allowed(outer):
            return 10.0 + float(np.abs(outer).sum())
        return self._solve(outer, self._some)[2]

    def model(self, outer: np.ndarray) -> HysteresisModel:
        """Return the best model with these envelopes and this lag."""
        linear, offset, _ = self._solve(outer, self._all)
        left, middle, right = linear[:3] * self._scale
        slope = np.array([left / 4 + middle / 2 + right / 4, (right - left) / 2, left / 4 - middle / 2 + right / 4])
        slope[0] += LEAST_SLOPE * self._scale
        cubic = [self._mean + offset * self._scale, slope[0], slope[1] / 2, slope[2] / 3]
        thresholds, weights = self._thresholds, linear[3:] * self._scale
        kept = weights > 0
        kept[0] |= not kept.any()
        return HysteresisModel(
            *self._range,
            np.array(cubic),
            outer[0:2],
            outer[2:4],
            thresholds[kept],
            weights[kept],
            self._rate,
            lag=self._lag(outer),
            delay=self._settings.delay,
        )

    def _is_allowed(self, outer: np.ndarray) -> bool:
        rising, falling = (abs(2 * outer[k]) + abs(3 * outer[k + 1]) for k in (0, 2))
        return max(rising, falling) <= STEEPEST_ENVELOPE and 0 <= self._lag(outer) <= LONGEST_LAG

    def _lag(self, outer: np.ndarray) -> float:
        return float(outer[4]) * LONGEST_LAG if len(outer) > 4 else 0.0

    def _solve(self, outer: np.ndarray, samples: np.ndarray) -> tuple[np.ndarray, float, float]:
        """Return linear parameters, >= 0, the constant, and the rms left over, all of the response's own rms."""
        late = np.maximum(samples - self._settings.delay, 0)
        columns = self._parts(outer)[:, late].T
        means = columns.mean(axis=0)
        steady = LEAST_SLOPE * columns[:, :3].sum(axis=1)
        target = self._wanted[samples] - self._wanted[samples].mean() - (steady - steady.mean())
        centred = columns - means
        centred[:, np.ptp(centred, axis=0) < STILL] = 0.0
        compressed = np.asarray(np.linalg.qr(np.column_stack([centred, target]) / np.sqrt(len(target)), mode="r"))
        bounded = np.vstack([compressed[:, :-1], np.sqrt(SMALL_WEIGHTS) * np.eye(centred.shape[1])])
        linear, left_over = nnls(bounded, np.concatenate([compressed[:, -1], np.zeros(centred.shape[1])]))
        return linear, float(-means @ linear - steady.mean()), float(left_over)

    def _parts(self, outer: np.ndarray) -> np.ndarray:
        """Return what the response is made of beside a constant, (parts, samples): three rising cubics, the plays."""
        count = self._settings.plays
        parts: np.ndarray = np.empty((3 + count, len(self._voltage)))
        parts[:3] = self._cubics
        shape = np.array([*self._range, 0, 1, 0, 0, *outer[:4]])
        memory = np.empty(count + 1)
        kernel.reset(self._voltage[0], shape, memory)
        kernel.play(self._voltage, shape, np.column_stack([self._thresholds, np.ones(count)]), memory, parts[3:])
        lag = self._lag(outer)
        if lag > 0:
            pole = float(np.exp(-1 / (self._rate * lag)))
            for part in parts:
                kernel.lag(part, pole)
        return parts


def _simplex(problem: _Problem, start: np.ndarray) -> np.ndarray:
    """Return the best envelopes, and lag, near `start`."""
    options = {
        "maxfev": SIMPLEX_STEPS,
        "xatol": 1e-3,
        "fatol": 1e-7,
        "initial_simplex": np.vstack([start, start + SIMPLEX_SIZE * np.eye(len(start))]),
    }
    found: np.ndarray = minimize(problem.residual, start, method="Nelder-Mead", options=options).x
    return found


def _refuse_unfit(voltage: np.ndarray, response: np.ndarray, rate: float, fitted: slice, settings: Settings) -> None:
    if voltage.ndim != 1 or voltage.shape != response.shape:
        raise ValueError(f"voltage has shape {voltage.shape} and response {response.shape}, must be alike: (samples,)")
    if not (np.all(np.isfinite(voltage)) and np.all(np.isfinite(response))):
        raise ValueError("voltage or response has samples that are not finite")
    if not (np.isfinite(rate) and rate > 0):
        raise ValueError(f"rate is {rate}, must be > 0 samples/s")
    least = 5 * (settings.plays + 5) + settings.delay
    if not len(response[fitted]) >= least:
        raise ValueError(f"{len(response[fitted])} samples to fit, must be >= {least} for {settings.plays} plays")
    if not (np.ptp(voltage) > 0 and np.ptp(response[fitted]) > 0):
        raise ValueError("voltage or response does not move")
