"""How large an outer loop's gains may be where no model holds, from what the stage was heard to do there."""

import numpy as np

from calibration.stage_axes.above import HeardResponse
from calibration.state_space.model import InnovationModel
from stagectl.config import Outer
from stagectl.stage.allowed_gains import BINS, AllowedGains, frequencies_above, of_axis
from stagectl.stage.measured_response import SMALL

ANSWER = 1.0
"""Largest answer to a reference there, where it is not known what a laser sees."""


def quiet_above(
    outer: Outer, axis: int, model: InnovationModel, above: HeardResponse, seen: HeardResponse | None
) -> AllowedGains:
    """Return the gains above `Outer.reach` that what was measured there allows, and the settings.

    Small gain: a resonance that no model has may have any phase, so the loop's gain must be below one there.  Nor may
    it answer a reference strongly: what compensates a deflection makes the reference of what laser and plate's sensor
    see of the plate, and they do not see the same there; a loop, whose gain must be small as well.

    Parameters
    ----------
    outer : Outer
        Resonances may be elsewhere by its `mistuning`; where the stage is silent its `beyond` holds.
    axis : int, counted from 0
    model : InnovationModel
        From the inner loop's reference (m) to the position (m).
    above : HeardResponse, m/m
        To the position.
    seen : HeardResponse or None, m/m
        To what a deflection's compensation takes for the robot's motion; None without a laser.

    Source
    ------
    Skogestad and Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section 4.9.
    """
    frequency = frequencies_above(outer, model.rate)
    if len(frequency) == 0:
        return AllowedGains(frequency, frequency)
    at_rest = abs(model.frequency_response(np.zeros(1))[0, 0, 0])
    spread = outer.mistuning + 0.5 * np.log(frequency[-1] / frequency[0]) / (BINS - 1)
    small, answer = SMALL * at_rest, ANSWER * at_rest
    gain, beyond = above.near(frequency, spread), of_axis(outer.beyond, axis)
    forward = _within(answer, gain) if seen is None else _within(small, seen.near(frequency, spread))
    return AllowedGains(np.minimum(beyond, _within(small, gain)), np.minimum(outer.forward_beyond, forward))


def _within(allowed: float, measured: np.ndarray) -> np.ndarray:
    """Return by how much gains may be multiplied; without end where noise alone was measured."""
    within: np.ndarray = np.divide(allowed, measured, out=np.full_like(measured, np.inf), where=measured > 0)
    return within
