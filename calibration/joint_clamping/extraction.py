"""Backlash, stiffness and friction from a torque-position map, by nonlinear least squares with robust weights.

The model of the motor's torque over its angle x from the middle of the backlash, on the joint's side of the gear:

    torque = k+ u + k- d [+ c+ u^3 + c- d^3] + (f + g+ u - g- d) F + offset + drift,
    u = max(x - b/2, 0), d = min(x + b/2, 0),

with F Dahl's friction, from -1 to 1.  b is free to be negative: where there is no backlash its estimate scatters about
zero, and its interval says how much could have been missed.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from calibration.joint_clamping.correlation import correlation_length
from calibration.joint_clamping.friction import friction_shape
from calibration.joint_clamping.joint_model import CONFIDENCE, Estimate, JointModel, Spring
from calibration.joint_clamping.torque_map import Branches, TorqueMap, TorqueMapError, branches
from calibration.one_thread import on_one_thread

FEWEST = 50
"""Samples that a fit takes."""
MIDDLE_TORQUE = (0.5, 0.35)
"""Of the largest torque, within which the backlash is found once more."""
SETTLED = 0.03
"""Part of the span after a reversal that does not count: there friction turns round, and the motor may stick."""

NONLINEAR = 3
"""The first parameters: middle, backlash, logarithm of the presliding distance."""
MIDDLE, BACKLASH, PRESLIDING = range(NONLINEAR)
K_PLUS, K_MINUS, FRICTION, LOAD_PLUS, LOAD_MINUS, OFFSET = range(6)
"""Linear parameters, after which the drifts and a smooth spring's cubics come."""

USUAL_OFFSET = 0.02
"""Of the torque, over its largest value.  Decides only where the data cannot: a straight spring without backlash has
no middle, and offset and middle are then one."""

HUBER = 3.0
"""Residuals beyond so many standard deviations weigh less."""

START_BACKLASH = (0.0, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7)
START_MIDDLE = np.linspace(-0.3, 0.3, 13)
"""Over the span."""

MOST_STEPS = 40
"""Of the regression; a joint needs about ten, a record that is none would go on for long."""

WORTH = 0.03
"""Part by which a smooth spring must lessen the residual's variance to be preferred."""

MOST_BACKLASH, NO_BACKLASH = 0.9, 1e-9
"""Bounds of the backlash, either sign, over the span."""

FLATTEST, WIDEST = 1e-4, 0.15
"""Bounds of the presliding distance over the span; friction that turns round later looks like a spring."""


@dataclass(frozen=True)
class _Data:
    """A map scaled to its span and its largest torque; only samples with `used` count."""

    angle: np.ndarray
    torque: np.ndarray
    time: np.ndarray
    cut: Branches
    used: np.ndarray
    span: float
    middle: float
    scale: float


@dataclass(frozen=True)
class _Fit:
    parameters: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    cost: float
    smooth: bool


@on_one_thread
def extract(joint: TorqueMap, spring: Spring | None = None) -> JointModel:
    """Extract a joint's model from its torque-position map.

    Parameters
    ----------
    joint : TorqueMap
        At least two cycles at a low speed; what comes before the first reversal does not count.
    spring : "piecewise linear", "smooth" or None
        None: the smooth one if its cubics are significant and lessen the residual's variance by `WORTH`.

    Raises
    ------
    TorqueMapError : a record too short, without reversals, or whose torque does not grow with the angle.

    Source
    ------
    Sornmo 2015, 4.3, Parameter extraction; fig. 4.2.

    Departs
    -------
    One regression for all parameters at once, friction among them, in place of one on each branch by hand: a branch
    alone cannot tell friction that grows with the load from stiffness.
    """
    data = _data(joint)
    if spring is not None:
        return _judged(_fitted(data, spring == "smooth", MOST_BACKLASH), data)
    straight, smooth = (_fitted(data, bent, MOST_BACKLASH) for bent in (False, True))
    model = _model(smooth, data)
    better = smooth.cost < (1 - WORTH) * straight.cost
    clear = any(abs(each.value) > each.reach * each.error for each in (model.cubic_plus, model.cubic_minus))
    return _judged(smooth if better and clear else straight, data)


def _judged(fit: _Fit, data: _Data) -> JointModel:
    """Return the model; without backlash where leaving it out costs less than `WORTH` of the residual's variance."""
    model = _model(fit, data)
    model = replace(model, backlash=_widened(model.backlash, data))
    without = _fitted(data, fit.smooth, NO_BACKLASH)
    if model.backlash.is_significant and fit.cost < (1 - WORTH) * without.cost:
        return model
    return replace(_model(without, data), backlash=model.backlash, has_backlash=False)


def _widened(backlash: Estimate, data: _Data) -> Estimate:
    """Return the backlash, its interval wider by how far it is elsewhere where only the middle of the torque is fitted.

    What gives way behind the gear, and other motors that slide a little, bend the flanks as no noise does: the scatter
    of strokes does not show it, but the backlash then depends on how far out a flank is fitted.
    """
    torque = np.abs(data.torque - np.median(data.torque))
    off = 0.0
    for share in MIDDLE_TORQUE:
        inner = replace(data, used=data.used & (torque < share * torque.max()))
        if inner.used.sum() < FEWEST:
            continue
        with suppress(TorqueMapError):
            found = _fitted(inner, False, MOST_BACKLASH).parameters[BACKLASH] * data.span
            off = max(off, abs(float(found) - backlash.value))
    return replace(backlash, error=backlash.error + off / backlash.reach)


def _data(joint: TorqueMap) -> _Data:
    thin = joint.thinned()
    cut = branches(thin)
    span = float(np.ptp(thin.angle))
    middle = float(thin.angle.min()) + span / 2
    scale = float(np.ptp(thin.torque)) / 2
    used = (cut.number > 0) & (cut.since > SETTLED * span)
    if used.sum() < FEWEST:
        raise TorqueMapError(f"{used.sum()} samples are away from reversals, must be >= {FEWEST}")
    time = np.linspace(-1.0, 1.0, len(thin.angle))
    return _Data((thin.angle - middle) / span, thin.torque / scale, time, cut, used, span, middle, scale)


def _terms(data: _Data, nonlinear: np.ndarray, smooth: bool) -> np.ndarray:
    """Return what the linear parameters weigh, shape (samples used, linear parameters)."""
    middle, backlash, presliding = nonlinear
    twist = data.angle - middle
    up, down = np.maximum(twist - backlash / 2, 0.0), np.minimum(twist + backlash / 2, 0.0)
    friction = friction_shape(data.angle, float(np.exp(presliding)))
    terms = [up, down, friction, friction * up, -friction * down, np.ones(len(up))]
    terms += [data.time, data.time**2 - 1 / 3, friction * data.time]
    if smooth:
        terms += [up**3, down**3]
    return np.asarray(np.stack(terms, axis=1)[data.used])


def _fitted(data: _Data, smooth: bool, most_backlash: float) -> _Fit:
    torque = data.torque[data.used]
    start = _start(data, smooth, most_backlash)
    first = _terms(data, start[:NONLINEAR], smooth) @ start[NONLINEAR:] - torque
    noise = max(1.4826 * float(np.median(np.abs(first))), 1e-6)

    def left(parameters: np.ndarray) -> np.ndarray:
        misfit = _terms(data, parameters[:NONLINEAR], smooth) @ parameters[NONLINEAR:] - torque
        return np.asarray(np.append(misfit, noise * parameters[NONLINEAR + OFFSET] / USUAL_OFFSET))

    count = len(start)
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    low[PRESLIDING], high[PRESLIDING] = np.log(FLATTEST), np.log(WIDEST)
    low[BACKLASH], high[BACKLASH] = -most_backlash, most_backlash
    low[MIDDLE], high[MIDDLE] = -0.7, 0.7
    found = least_squares(
        left, start, bounds=(low, high), x_scale="jac", loss="huber", f_scale=HUBER * noise, max_nfev=MOST_STEPS
    )
    residual = left(found.x)
    prior = np.zeros((1, count))
    prior[0, NONLINEAR + OFFSET] = noise / USUAL_OFFSET
    jacobian = np.concatenate([_jacobian(data, found.x, smooth), prior])
    weight = np.sqrt(np.minimum(1.0, HUBER * noise / np.maximum(np.abs(residual), 1e-300)))
    return _Fit(found.x, weight * residual, weight[:, None] * jacobian, float(found.cost), smooth)


def _start(data: _Data, smooth: bool, most_backlash: float) -> np.ndarray:
    """Return the best of a grid of nonlinear parameters, with the linear ones that fit each and no offset.

    With an offset, a middle far off and no backlash would often fit well enough to be taken, and never be left again.
    """
    few = slice(None, None, max(1, int(data.used.sum()) // 1_000))
    torque = data.torque[data.used][few]
    best, found = np.inf, np.zeros(0)
    for backlash in (gap for gap in START_BACKLASH if gap < most_backlash):
        for middle in START_MIDDLE:
            nonlinear = np.array([middle, backlash, np.log(0.01)])
            terms = _terms(data, nonlinear, smooth)[few]
            terms[:, OFFSET] = 0.0
            linear, *_ = np.linalg.lstsq(terms, torque, rcond=1e-9)
            left = float(np.sum((terms @ linear - torque) ** 2))
            if left < best and min(linear[K_PLUS], linear[K_MINUS]) > 0:
                best, found = left, np.concatenate([nonlinear, linear])
    if not len(found):
        raise TorqueMapError("the torque does not grow with the angle on both sides of zero; is the arm clamped?")
    return found


def _jacobian(data: _Data, parameters: np.ndarray, smooth: bool) -> np.ndarray:
    """Return the derivatives of the modelled torque, shape (samples used, parameters)."""
    nonlinear, linear = parameters[:NONLINEAR], parameters[NONLINEAR:]
    columns = []
    for number, step in enumerate((1e-5, 1e-5, 1e-4)):
        ahead, behind = (_terms(data, nonlinear + sign * step * np.eye(NONLINEAR)[number], smooth) for sign in (1, -1))
        columns.append((ahead - behind) @ linear / (2 * step))
    return np.concatenate([np.stack(columns, axis=1), _terms(data, nonlinear, smooth)], axis=1)


def _covariance(fit: _Fit, data: _Data) -> np.ndarray:
    """Return the parameters' covariance, shape (parameters, parameters), scaled units.

    The larger, parameter by parameter, of two: from the scatter between branches, each of which counts as one
    observation, and from the residual's variance over as many samples as are independent of each other.
    """
    jacobian, residual = fit.jacobian, fit.residual
    size = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-9)  # nothing depends on a presliding at its bound
    inverse = np.linalg.pinv((jacobian / size).T @ (jacobian / size), rcond=1e-12, hermitian=True) / np.outer(
        size, size
    )
    number = data.cut.number[data.used]
    scores = jacobian[:-1] * residual[:-1, None]
    sums = np.array([scores[number == each].sum(axis=0) for each in np.unique(number)])
    between = len(sums) / (len(sums) - 1) * inverse @ sums.T @ sums @ inverse
    along = float(np.mean(residual**2)) * correlation_length(residual[:-1]) * inverse
    scale = np.sqrt(np.maximum(np.diag(between) / np.maximum(np.diag(along), 1e-300), 1.0))
    found: np.ndarray = along * np.outer(scale, scale)
    return found


def _model(fit: _Fit, data: _Data) -> JointModel:
    values, covariance = fit.parameters, _covariance(fit, data)
    errors = np.sqrt(np.diag(covariance))
    reach = float(student.ppf(0.5 + CONFIDENCE / 2, max(len(np.unique(data.cut.number[data.used])) - 2, 1)))
    stiffness, none = data.scale / data.span, Estimate(0.0, 0.0, reach)

    def estimate(place: int, unit: float) -> Estimate:
        return Estimate(float(values[place] * unit), float(errors[place] * unit), reach)

    cubic = [none, none]
    if fit.smooth:
        cubic = [estimate(place, stiffness / data.span**2) for place in (len(values) - 2, len(values) - 1)]
    torque = data.scale * data.torque[data.used]
    return JointModel(
        "smooth" if fit.smooth else "piecewise linear",
        estimate(BACKLASH, data.span),
        estimate(NONLINEAR + K_PLUS, stiffness),
        estimate(NONLINEAR + K_MINUS, stiffness),
        cubic[0],
        cubic[1],
        estimate(NONLINEAR + FRICTION, data.scale),
        _friction_load(values[NONLINEAR:], covariance[NONLINEAR:, NONLINEAR:], reach),
        presliding=float(np.exp(values[PRESLIDING]) * data.span),
        centre=float(values[MIDDLE] * data.span + data.middle),
        offset=float(values[NONLINEAR + OFFSET] * data.scale),
        residual=float(np.std(fit.residual) * data.scale),
        torque_range=(float(torque.min()), float(torque.max())),
        cycles=data.cut.reversals / 2,
        has_backlash=True,
    )


def _friction_load(linear: np.ndarray, covariance: np.ndarray, reach: float) -> Estimate:
    """Return what friction grows by per torque of the spring, both sides together."""
    stiffness = float(linear[K_PLUS] + linear[K_MINUS])
    both = covariance[LOAD_PLUS : LOAD_MINUS + 1, LOAD_PLUS : LOAD_MINUS + 1].sum()
    return Estimate(float(linear[LOAD_PLUS] + linear[LOAD_MINUS]) / stiffness, float(np.sqrt(both)) / stiffness, reach)
