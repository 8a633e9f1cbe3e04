"""A filter before the outer loop, made for how a deflection moves, within the bounds that the loop itself keeps."""

from dataclasses import dataclass, replace

import numpy as np

from stagectl.config import Outer
from stagectl.stage.bounded_fit import bounded_fit
from stagectl.stage.design import Design
from stagectl.stage.design_bounds import mistuned
from stagectl.stage.disturbance import Disturbance
from stagectl.stage.measured_response import SMALL, MeasuredResponse, near
from stagectl.stage.state_feedback import StateFeedback, ramp_feedforward
from stagectl.stage.state_space import plant_of

LENGTH, SPACING = 100, 1e-3
"""Coefficients, and s from one to the next."""
LARGEST = 4.0
"""Gain at any frequency, so that a sensor's noise stays noise."""
HIGHEST = 240.0
"""Hz up to which a deflection is compensated."""
LOWEST, LINES, NEAR = 0.3, 700, np.linspace(0.92, 1.08, 49)
"""Hz, lines from there to half the rate, and those around each resonance, re its frequency."""
OFFS = np.linspace(-1.0, 1.0, 9)
"""Of `Outer.mistuning`: how far off natural frequencies are where the answer is bounded."""
SPREAD, WIDTH = 0.02, 1.0
"""Of each frequency, and Hz below: what was heard so far away counts there."""
ROUNDED = 1.02
"""Re its bound: what a filter from a file may reach."""


@dataclass(frozen=True, eq=False)
class Prefilter:
    """What the reference goes through before the outer loop follows it, and the l_r of the loop that it is made for.

    Every sample is the mean of the last `spacing` references, and of those before at distances of `spacing`, by `taps`.

    Parameters
    ----------
    taps : array, shape (n,), 1
        Their sum is one: a reference at rest is kept.
    spacing : int, samples
    forward : float, m/m
        l_r, in place of the design's.
    left, without : float, 1
        What of the deflection that it was made for is left by loop and filter, and by the loop as designed; root mean
        squares, re that of the deflection.
    """

    taps: np.ndarray
    spacing: int
    forward: float
    left: float
    without: float

    def response(self, frequency: np.ndarray, rate: float) -> np.ndarray:
        """Return its frequency response, complex, shape (bins,), 1.

        Parameters
        ----------
        frequency : array, shape (bins,), Hz
        rate : float, samples/s
        """
        answer: np.ndarray = _each(frequency, len(self.taps), self.spacing, rate) @ self.taps
        return answer


def prefilter(
    design: Design, outer: Outer, seen: Disturbance, late: float, measured: MeasuredResponse | None = None
) -> Prefilter | None:
    """Make the filter that leaves least of a deflection, within the bounds of a design.

    What compensates a deflection is a loop as well, as far as laser and plate's sensor do not see the plate alike: its
    gain stays below `SMALL`, as measured, or were their timing off by all of `late`.  The loop's answer to a reference
    stays within `Outer.max_sensitivity`, and where natural frequencies are off by up to `Outer.mistuning`, and as
    measured, within `Outer.mistuned_sensitivity`; above `Outer.reach` the gain from the reference stays within what was
    allowed to the design.  l_r is the design's, or the one that leaves no error on a ramp.

    Parameters
    ----------
    design : Design
    outer : Outer
    seen : Disturbance
    late : float, s
        By which the reference comes late: what is seen of a deflection is that old.
    measured : MeasuredResponse, optional
        Of the same plant.

    Returns
    -------
    Prefilter or None
        None where nothing is better than the loop alone.
    """
    plain = _Answers(design, outer, design.loop.forward, late, measured)
    power = seen.power(plain.frequency, outer.disturbance) * (plain.frequency <= HIGHEST)
    if not power.sum() > 0:
        return None
    without = _left(power, plain.answer)
    made = [_fitted(plain, power, without)]
    ramp = outer.feedforward * ramp_feedforward(design.loop)
    if np.isfinite(ramp):
        made.append(_fitted(_Answers(design, outer, ramp, late, measured), power, without))
    best = min((each for each in made if each is not None), key=lambda each: each.left, default=None)
    return None if best is None or best.left >= without else best


def missed(loop: StateFeedback, filters: Prefilter | None, late: float, frequency: np.ndarray) -> np.ndarray:
    """Return what a loop, behind a prefilter with the l_r of that, leaves of a deflection: shape (bins,), 1.

    Parameters
    ----------
    loop : StateFeedback
    filters : Prefilter or None
    late : float, s
        By which the reference comes late.
    frequency : array, shape (bins,), Hz
    """
    rate, plant = loop.model.rate, plant_of(loop.model).response(frequency, loop.model.rate)
    led = loop if filters is None else replace(loop, forward=filters.forward)
    before = 1.0 if filters is None else filters.response(frequency, rate)
    answer = before * led.reference_system().response(frequency, rate) * plant
    answer = answer / (1.0 + loop.system().response(frequency, rate) * plant)
    left: np.ndarray = np.abs(1.0 - answer * np.exp(-2j * np.pi * frequency * late))
    return left


def refuse_unfit(
    filters: Prefilter,
    design: Design,
    outer: Outer,
    late: float,
    name: str,
    measured: MeasuredResponse | None = None,
) -> None:
    """Refuse, by ValueError, a filter with which the loop would answer a reference more strongly than its bounds allow.

    Parameters
    ----------
    filters : Prefilter
    design : Design
    outer : Outer
    late : float, s
        As of `prefilter`.
    name : str
        Of its file and axis.
    measured : MeasuredResponse, optional
        As of `prefilter`.
    """
    answers = _Answers(design, outer, filters.forward, late, measured)
    over = float(np.max(answers.share * np.abs(filters.response(answers.frequency, design.loop.model.rate))))
    if not over <= ROUNDED:
        raise ValueError(
            f"{name} belongs to another loop: with it the answer to a reference, or the gain from it, is {over:.3g} of "
            "what [outer] allows, must be <= 1; make it again: run with session.compare"
        )


class _Answers:
    """A loop's answer to the reference over frequency, and the gains that a filter before it may have."""

    def __init__(
        self, design: Design, outer: Outer, forward: float, late: float, measured: MeasuredResponse | None
    ) -> None:
        loop, rate = design.loop, design.loop.model.rate
        plant, modes = plant_of(loop.model), loop.model.modes
        rings = modes.frequency[(modes.damping < 1.0) & (modes.frequency < rate / 4)]
        lines = np.geomspace(LOWEST, 0.99 * rate / 2, LINES)
        self.frequency = np.unique(np.concatenate([lines, np.outer(rings, NEAR).ravel()]))
        self.rate, self.forward, self.spacing = rate, forward, max(1, round(SPACING * rate))
        feedback = loop.system().response(self.frequency, rate)
        led = replace(loop, forward=forward)
        reference = self._reference(led)
        answers = []
        for off in OFFS:
            there = mistuned(plant, 1.0 + off * outer.mistuning).response(self.frequency, rate)
            answers.append(reference * there / (1.0 + feedback * there))
        tuned = answers[len(OFFS) // 2]
        self.answer = tuned * np.exp(-2j * np.pi * self.frequency * late)
        turned = np.minimum(2 * np.pi * self.frequency * late, 2.0)  # were the deflection's timing off by as much again
        heard, answer, compensation = self._heard(led, measured)
        gains = [np.where(heard, compensation, np.abs(tuned) * turned) / SMALL, answer / outer.mistuned_sensitivity]
        gains += [np.abs(tuned) / outer.max_sensitivity, np.max(np.abs(answers), axis=0) / outer.mistuned_sensitivity]
        allowed = np.abs(self._reference(loop)) / max(design.forward_share, np.finfo(float).tiny)
        gains.append(np.where(self.frequency >= outer.reach, np.abs(reference) / np.maximum(allowed, 1e-12), 0.0))
        self.share = np.max(gains, axis=0)
        """Of what is allowed, without a filter, shape (bins,), 1."""

    def _heard(self, led: StateFeedback, measured: MeasuredResponse | None) -> tuple[np.ndarray, ...]:
        """Return where the plant was heard, and its answer and the compensation's gain near there: (bins,) each."""
        if measured is None:
            return np.zeros(len(self.frequency), bool), *np.zeros((2, len(self.frequency)))
        found = measured.answers(led)
        bins = list(zip(*near(measured.frequency, self.frequency, SPREAD, WIDTH), strict=True))
        sides = measured.position != 0, found.answer, found.compensation
        return tuple(np.array([each[low:high].max(initial=0) for low, high in bins]) for each in sides)

    def _reference(self, loop: StateFeedback) -> np.ndarray:
        return loop.reference_system().response(self.frequency, self.rate)

    @property
    def each(self) -> np.ndarray:
        """The answer of each coefficient by itself: shape (bins, n), 1."""
        return _each(self.frequency, LENGTH, self.spacing, self.rate)


def _each(frequency: np.ndarray, count: int, spacing: int, rate: float) -> np.ndarray:
    """Return the frequency response of each coefficient, a mean of `spacing` samples, shape (bins, count), 1."""
    turn = 2j * np.pi * frequency[:, np.newaxis] / rate
    mean = np.exp(-turn * np.arange(spacing)).mean(axis=1, keepdims=True)
    response: np.ndarray = mean * np.exp(-turn * spacing * np.arange(count))
    return response


def _left(power: np.ndarray, answer: np.ndarray) -> float:
    return float(np.sqrt(np.sum(power * np.abs(1.0 - answer) ** 2) / np.sum(power)))


def _fitted(answers: _Answers, power: np.ndarray, without: float) -> Prefilter | None:
    each, counts = answers.each, power > 0
    weight = np.sqrt(power[counts] / power.sum())
    rows = (weight * answers.answer[counts])[:, np.newaxis] * each[counts]
    bounds = np.maximum(answers.share, 1.0 / LARGEST)[:, np.newaxis] * each
    taps = bounded_fit(rows, weight.astype(complex), bounds)
    if taps is None:
        return None
    return Prefilter(taps, answers.spacing, answers.forward, _left(power, answers.answer * (each @ taps)), without)
