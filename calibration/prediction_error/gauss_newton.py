"""Fit elements in parallel to records by a damped Gauss-Newton method (Levenberg and Marquardt), derivatives exact."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import solve_triangular

from calibration.prediction_error.element import Element, margins
from calibration.prediction_error.local_coordinates import Coordinates, Rule, around
from calibration.prediction_error.normal_equations import Normal, Record, normal_equations, residual_covariance
from calibration.prediction_error.parallel_form import decomposed, joined

FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-12, 1e8
EASE, BRAKE = 0.2, 5.0
"""Factors on the damping after a step that was taken, and after one that was not."""

NEAR_ENOUGH = 1e-4
"""The fit has arrived when the step left is, on average, this share of a parameter's variance (1 % of its error)."""

LEAST_GAIN = 1e-9
"""It has arrived, too, when twice in a row a step lowers the criterion, a logarithm of variances, by less than this."""

LEAST_VARIANCE = 1e-20
"""Of residuals, relative to the output's: what is smaller is rounding."""

SHARE = 0.9
"""Of the way to the limit of stability that one step may take a pole."""


def unseen(iteration: int, gain: float) -> None:
    """Show nothing of an iteration."""


@dataclass(frozen=True, eq=False)
class Effort:
    """When a fit ends at the latest, and who is shown how far it is.

    Parameters
    ----------
    iterations : int
    seconds : float, s, optional
        Of the clock: where it ends by this, what is found depends on the machine.
    show : callable(int, float), optional
        Told of each iteration, and by how much the criterion, a logarithm of variances, was lowered by it.
    """

    iterations: int
    seconds: float = float("inf")
    show: Callable[[int, float], object] = unseen
    began: float = field(default_factory=time.monotonic)

    @property
    def is_over(self) -> bool:
        """Whether the time is up."""
        return time.monotonic() - self.began > self.seconds


@dataclass(frozen=True, eq=False)
class Point:
    """Elements in parallel, and how they fit.

    Parameters
    ----------
    elements : tuple of Element
    direct : array, shape (outputs, direct inputs), any unit
    states : tuple of tuples of arrays, shape (n,), 1
        At the start of each record, element by element.
    covariance : array, shape (outputs, outputs), products of the targets' units
        Of the residuals.
    weight : array, shape (outputs, outputs), 1 per the targets' units
        By which residuals are multiplied in the criterion.
    """

    elements: tuple[Element, ...]
    direct: np.ndarray
    states: tuple[tuple[np.ndarray, ...], ...]
    covariance: np.ndarray
    weight: np.ndarray

    @property
    def cost(self) -> float:
        """The criterion."""
        return -2 * float(np.sum(np.log(np.diag(self.weight))))


@dataclass(frozen=True, eq=False)
class Fit:
    """What a fit has found.

    Parameters
    ----------
    point : Point
    coordinates : Coordinates
        Around it.
    states : tuple of arrays, shape (all states,), 1
        Of the coordinates' sections, at the start of each record.
    normal : Normal
        The normal equations there.
    iterations : int
    arrived : bool
        Whether it ended at an optimum, rather than at the limit of its effort or where no step helps.
    """

    point: Point
    coordinates: Coordinates
    states: tuple[np.ndarray, ...]
    normal: Normal
    iterations: int
    arrived: bool


def fit(
    elements: Sequence[Element],
    direct: np.ndarray,
    records: Sequence[Record],
    rule: Rule,
    *,
    joint: bool,
    effort: Effort,
) -> Fit:
    """Lower the criterion until the step left is 1 % of a standard error, keeping every element stable.

    The criterion is log det of the residuals' covariance, Gaussian maximum likelihood, where `joint`; else the sum of
    the logarithms of the residuals' variances, output by output.

    Parameters
    ----------
    elements : sequence of Element
        Stable ones.
    direct : array, shape (outputs, direct inputs), any unit
    records : sequence of Record
    rule : function
        What may step.
    joint : bool
    effort : Effort

    Source
    ------
    Ljung, System Identification, 2nd ed., 1999, sections 7.4 and 10.2; Marquardt 1963, SIAM J. Appl. Math. 11(2).
    """
    rest = [[np.zeros(len(element.a)) for element in elements]] * len(records)
    point = _point(elements, direct, rest, records, joint)
    if point is None:
        raise ValueError("the model to start from responds with numbers too large to compute with")
    here = _linearised(point, records, rule)
    damping, small, done, arrived = FIRST_DAMPING, 0, 0, False
    while done < effort.iterations and damping <= MOST_DAMPING and not (arrived or effort.is_over):
        done += 1
        trial = _stepped(here, damping, records, joint)
        gain = 0.0 if trial is None else max(0.0, point.cost - trial.cost)
        effort.show(done, gain)
        if trial is not None and gain > 0.0:
            small = small + 1 if gain < LEAST_GAIN else 0
            point, damping = trial, max(damping * EASE, LEAST_DAMPING)
            here = _linearised(point, records, rule)
        else:
            damping *= BRAKE
        arrived = small == 2 or here.left <= NEAR_ENOUGH * len(here.normal.slope)
    return Fit(point, here.coordinates, tuple(here.states), here.normal, done, arrived)


@dataclass(frozen=True, eq=False)
class _Linearised:
    """What a step from a point is made of."""

    coordinates: Coordinates
    states: list[np.ndarray]
    normal: Normal
    fences: tuple[np.ndarray, np.ndarray]
    left: float


def _linearised(point: Point, records: Sequence[Record], rule: Rule) -> _Linearised:
    at, states = around(point.elements, point.direct, point.states, rule)
    normal = normal_equations(at.form, at.slopes, records, states, point.weight)
    fences = _fences(at)
    return _Linearised(at, states, normal, fences, normal.gain(normal.step(0.0, *fences)))


def _stepped(here: _Linearised, damping: float, records: Sequence[Record], joint: bool) -> Point | None:
    """Return the point after a step, or None where it is unstable."""
    step = here.normal.step(damping, *here.fences)
    elements, direct = here.coordinates.moved(step)
    if not all(element.is_stable for element in elements):
        return None
    moves = zip(here.states, here.normal.state_steps(step), strict=True)
    states = [here.coordinates.states_moved(state, move, step) for state, move in moves]
    return _point(elements, direct, states, records, joint)


def _fences(at: Coordinates) -> tuple[np.ndarray, np.ndarray]:
    """Return how far a step may take each pole, shape (poles,), and how it moves them, shape (poles, free)."""
    rooms, approaches, column = [np.zeros(0)], [np.zeros((0, at.slopes.shape[1]))], 0
    for element, steps in zip(at.elements, at.steps, strict=True):
        room, approach = margins(element, steps)
        wide = np.zeros((len(room), at.slopes.shape[1]))
        wide[:, column : column + len(steps.a)] = approach
        column += len(steps.a)
        rooms.append(SHARE * room)
        approaches.append(wide)
    return np.concatenate(rooms), np.concatenate(approaches)


def _point(
    elements: Sequence[Element],
    direct: np.ndarray,
    states: Sequence[Sequence[np.ndarray]],
    records: Sequence[Record],
    joint: bool,
) -> Point | None:
    """Evaluate the criterion; None where the response is too large for a number."""
    taken = [decomposed(element.a, element.b, element.c, element.first) for element in elements]
    form = joined([form for form, _ in taken], direct)
    sections = [
        np.concatenate([np.linalg.solve(basis, part) for (_, basis), part in zip(taken, record, strict=True)])
        for record in states
    ]
    covariance = residual_covariance(form, records, sections)
    if not np.isfinite(covariance).all():
        return None
    power = np.mean(np.concatenate([record.target for record in records]) ** 2, axis=0)
    safe = covariance + np.diag(LEAST_VARIANCE * power)
    root = np.linalg.cholesky(safe if joint else np.diag(np.diag(safe)))
    weight = solve_triangular(root, np.eye(len(root)), lower=True)
    return Point(tuple(elements), direct, tuple(tuple(record) for record in states), covariance, weight)
