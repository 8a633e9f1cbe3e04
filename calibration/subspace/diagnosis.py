"""What is to be thought of records and of a model of them: a verdict in a sentence each."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from calibration.fit_measures import Fit
from calibration.subspace.excitation import MOST
from calibration.subspace.feedback import Feedback
from calibration.subspace.nonlinearity import Nonlinearity

WHITE = 0.01
"""Probability of residuals as far from white ones, below which they are not."""
CROSSED = 0.05
"""Share of correlations beyond the bound of one in a hundred, up to which there are none."""
_MISLED = "this method takes part of the controller for the plant, take method auto or pbsid"
_RIGHT = "the model is by PBSID, which a loop does not mislead"
_SERIES = "there are no inputs: it is a model of what the outputs do by themselves, to be predicted with"
_EXCITED = "inputs excite enough for a model of this order"
SPENT = 20
"""Samples for each coefficient of the model, below which there are few."""
REMEMBERED = 10.0
"""By how much the prediction's fit, %, may fall where it begins from rest."""
EXPLAINED = 2.0
"""Fit of the free run, %, below which an output does not follow from the inputs."""


@dataclass(frozen=True)
class Diagnosis:
    """Of a model and the records that it was identified from.

    Parameters
    ----------
    order : int
    inputs, outputs : int
    samples : int
    persistence : int
        Order of which the inputs excite persistently, see `excitation.persistence`.
    whiteness : float, 0 to 1
        Probability of such residuals one step ahead, were they white.
    left_out : float, 0 to 1
        Share of correlations of residuals with earlier inputs that are beyond a bound of 1 %.
    feedback : Feedback
        Whether inputs follow from outputs.
    minds_loops : bool
        Whether the method goes wrong where they do.
    moved_poles : int
        Poles that had to be moved into the unit circle.
    nonlinearity : Nonlinearity
        Whether squares and cubes tell of the outputs.
    unexplained : tuple of int
        Outputs of which the free run tells next to nothing, counted from 0.
    remembering : tuple of int
        Outputs that are foretold far worse from rest than from a state that was fitted.
    unheard : tuple of str
        Sentences on inputs that no output hears of.
    """

    order: int
    inputs: int
    outputs: int
    samples: int
    persistence: int
    whiteness: float
    left_out: float
    feedback: Feedback
    minds_loops: bool
    moved_poles: int
    nonlinearity: Nonlinearity
    unexplained: tuple[int, ...] = ()
    remembering: tuple[int, ...] = ()
    unheard: tuple[str, ...] = ()

    @property
    def coefficients(self) -> int:
        """Of the model, that data determine."""
        return self.order * (self.inputs + 2 * self.outputs) + self.inputs * self.outputs

    @property
    def sentences(self) -> tuple[str, ...]:
        """Verdicts, what is well as well as what is not."""
        begin = _SERIES if not self.inputs else _EXCITED if self.persistence >= MOST else ""
        return (*([begin] if begin else []), *self.of_records, *self._of_residuals())

    @property
    def of_records(self) -> tuple[str, ...]:
        """Verdicts on what is not well with the records, and with the model because of them."""
        return (*self._of_inputs(), *self.unheard, *self._of_outputs(), *self.of_plant, *self._of_poles())

    @property
    def of_plant(self) -> tuple[str, ...]:
        """Verdicts on outputs that are not linear, and on inputs that follow from outputs, one each."""
        after = _MISLED if self.minds_loops else _RIGHT
        bent = () if self.feedback.inputs else self.nonlinearity.sentences  # in a loop inputs tell of outputs anyway
        return (*bent, *(f"{said}; {after}" for said in self.feedback.sentences))

    def __str__(self) -> str:
        """Return them a line each."""
        return "\n".join(self.sentences)

    def _of_inputs(self) -> Iterator[str]:
        if self.inputs and self.persistence < min(2 * self.order, MOST):
            yield (
                f"inputs excite persistently of order {self.persistence} only, {2 * self.order} is wanted: "
                "much of the model is not identifiable"
            )
        elif self.inputs and self.persistence < MOST:
            yield (
                f"inputs excite persistently of order {self.persistence}: enough for a model of this order, but "
                f"of more than {self.persistence // 2} states much would be guessed"
            )
        if self.samples * self.outputs < SPENT * self.coefficients:
            yield f"{self.samples} samples are few for {self.coefficients} coefficients"

    def _of_outputs(self) -> Iterator[str]:
        for output in self.unexplained:
            yield (
                f"the free run explains next to nothing of output {output + 1}: it is noise or drift, or belongs to "
                "other inputs than these"
            )
        for output in self.remembering:
            yield (
                f"from rest, output {output + 1} is predicted far worse over such a record than from a fitted initial "
                "state: start with initial_predictor_state of a first stretch, or let the predictor run in"
            )

    def _of_residuals(self) -> Iterator[str]:
        if self.whiteness >= WHITE:
            yield f"residuals one step ahead are white (probability {self.whiteness:.2g})"
        else:
            yield "residuals one step ahead are not white: noise or response have more to them than the model"
        if not self.inputs:
            return
        if self.left_out > CROSSED:
            yield (
                f"{100 * self.left_out:.0f} % of the residuals' correlations with earlier inputs are beyond their "
                "bound: the response has more to it than the model (order, delay, or a plant that is not linear), "
                "and standard errors do not hold"
            )
        else:
            yield "nothing of the inputs is left in the residuals"

    def _of_poles(self) -> Iterator[str]:
        if self.moved_poles:
            which = f"{self.moved_poles} poles were" if self.moved_poles > 1 else "1 pole was"
            yield (
                f"{which} moved into the unit circle: look at the records for drift or a step; where the plant itself "
                "is unstable or integrates, take stable=False (--unstable)"
            )


def diagnose(
    fit: Fit,
    order: int,
    samples: int,
    persistence: int,
    moved_poles: int,
    loop: tuple[Feedback, bool],
    told: tuple[Nonlinearity, tuple[str, ...]],
) -> Diagnosis:
    """Diagnose from a fit to the records themselves.

    Parameters
    ----------
    fit : Fit
    order : int
    samples : int
    persistence : int
    moved_poles : int
    loop : (Feedback, bool)
        And whether the method minds it.
    told : (Nonlinearity, tuple of str)
        And sentences on inputs that no output hears of.
    """
    cross = fit.cross_correlation
    beyond = np.abs(cross.correlation) > cross.bound
    outputs, inputs = cross.correlation.shape[1:]
    bent, unheard = told
    return Diagnosis(
        order,
        inputs,
        outputs,
        samples,
        persistence,
        float(fit.whiteness.probability),
        float(np.mean(beyond[cross.lag > 0])) if inputs else 0.0,
        *loop,
        moved_poles,
        bent,
        _outputs(fit.free_run.nrmse < EXPLAINED) if inputs else (),
        _outputs(fit.from_rest.nrmse < fit.one_step.nrmse - REMEMBERED),
        unheard,
    )


def _outputs(which: np.ndarray) -> tuple[int, ...]:
    return tuple(int(output) for output in np.flatnonzero(which))
