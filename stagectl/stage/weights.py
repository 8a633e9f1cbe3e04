"""The weights that an outer loop is made of, and the loop that they make."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.config import ChosenWeights, Outer
from stagectl.stage.kalman import NoGain, kalman_gain
from stagectl.stage.notches import behind, notches, with_notches
from stagectl.stage.servo import servo
from stagectl.stage.state_feedback import StateFeedback, linear_quadratic, ramp_feedforward
from stagectl.stage.state_space import StateSpace


@dataclass(frozen=True)
class Weights:
    """What LQ gain, Kalman filter, integral state and feedforward of an outer loop are made for.

    Parameters
    ----------
    bandwidth : float, Hz
        Of the integral action.
    drive : float, m/m
        Input that may be spent on an error of one: `linear_quadratic`.
    trust : float, 1
    doubt : float, m/m
        Of the identified noise, and in the plant's input: `kalman_gain`.
    caution : float, 1
        Weight of each mode by itself, in filter and feedback.
    feedforward : float, 1
        Part of the l_r that leaves no error on a ramp.
    notch : float, 1
        Damping ratio of the poles of `notches`; 0 for none.
    beyond : float, 1
        Gain above `Outer.reach`, re the plant at rest, that was found to be allowed with these; 0 for none found.
    forward_share : float, 1
        Of the gains from the reference that were found to be allowed there, what these take; 0 where it is to be found.
    """

    bandwidth: float
    drive: float
    trust: float
    doubt: float
    caution: float
    feedforward: float
    notch: float
    beyond: float = 0.0
    forward_share: float = 0.0


@dataclass(frozen=True)
class Ranges:
    """Values of each weight, every one to be tried with every other: the fields of `Weights`, trust with its doubt."""

    bandwidth: Sequence[float]
    drive: Sequence[float]
    trust_and_doubt: Sequence[tuple[float, float]]
    caution: Sequence[float]
    feedforward: Sequence[float]
    notch: Sequence[float] = (0.0,)


def chosen_weights(chosen: ChosenWeights, axis: int) -> Weights | None:
    """Return the weights that a rig file has for an axis, counted from 0; None where it has none."""
    if not chosen.bandwidth or not chosen.bandwidth[axis] > 0:
        return None
    given = {name: getattr(chosen, name) for name in ChosenWeights.model_fields}
    values = {name: values[axis] if values else 0.0 for name, values in given.items()}
    return Weights(**values | {"forward_share": values["forward_share"] or 1.0})


def loops(model: InnovationModel, outer: Outer, ranges: Ranges) -> Iterator[tuple[Weights, StateFeedback]]:
    """Make the loop of every combination that has an LQ gain and a filter.

    Parameters
    ----------
    model : InnovationModel
        From the inner loop's reference (m) to the plate's position (m).
    outer : Outer
        Whose `resonances` have states of their own.
    ranges : Ranges
    """
    for width in ranges.notch:
        notch = notches(model, outer.mistuning, width) if width > 0 else None
        if notch is None and width > 0:
            continue
        for caution in ranges.caution:
            yield from _of(model, notch, outer, replace(ranges, caution=(caution,), notch=(width,)))


def _of(
    model: InnovationModel, notch: StateSpace | None, outer: Outer, ranges: Ranges
) -> Iterator[tuple[Weights, StateFeedback]]:
    """Make the loops of one caution and of these notches."""
    caution, width = ranges.caution[0], ranges.notch[0]
    filters = list(_filters(model, ranges, caution))
    if not filters:
        return
    known = model if notch is None else behind(notch, model)
    for bandwidth, drive in product(ranges.bandwidth, ranges.drive):
        states = servo(outer, bandwidth, model.rate)
        try:
            feedback, servo_feedback = linear_quadratic(known, states, drive, caution)
        except NoGain:
            continue
        plain = StateFeedback(known, np.zeros((known.order, 1)), feedback, states, servo_feedback)
        if notch is not None:
            plain = with_notches(plain, notch, model)
        forward = ramp_feedforward(replace(plain, gain=_padded(filters[0][1], known)))  # the same for every filter
        for ((trust, doubt), gain), part in product(filters, ranges.feedforward):
            weights = Weights(bandwidth, drive, trust, doubt, caution, part, width)
            yield weights, replace(plain, gain=_padded(gain, known), forward=part * forward)


def _padded(gain: np.ndarray, model: InnovationModel) -> np.ndarray:
    """Return a filter's gain for a model with more states, that nothing measured tells of."""
    return np.pad(gain, ((0, model.order - len(gain)), (0, 0)))


def _filters(
    model: InnovationModel, ranges: Ranges, caution: float
) -> Iterator[tuple[tuple[float, float], np.ndarray]]:
    """Make the filters of every trust and doubt for which there is one."""
    for trust, doubt in ranges.trust_and_doubt:
        with suppress(NoGain):
            yield (trust, doubt), kalman_gain(model, doubt, caution, trust)
