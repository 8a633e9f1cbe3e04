"""Notches between feedback and plant, around resonances that are narrower than their frequency is known."""

import math
from dataclasses import replace

import numpy as np

from calibration.state_space.model import InnovationModel
from stagectl.stage.axis_record import MOST_STATES
from stagectl.stage.state_feedback import StateFeedback
from stagectl.stage.state_space import StateSpace, plant_of

DEPTH = 0.02
"""Damping ratio of a notch's zeros."""
BESIDE = 0.02
"""Of the frequency: how far the two notches of a group of resonances are below its lowest and above its highest."""


def notches(model: InnovationModel, mistuning: float, width: float) -> StateSpace | None:
    """Return two notches for each group of resonances whose damping ratio is below `mistuning`.

    Resonances are one group where they could be taken for one another.  A filter or an LQ gain that knows a narrow
    resonance feeds it with the wrong phase as soon as it lies elsewhere; a notch is made to let it alone.

    Parameters
    ----------
    model : InnovationModel
    mistuning : float, 1
        By which natural frequencies may be off.
    width : float, 1, > 0
        Damping ratio of the notches' poles.

    Returns
    -------
    StateSpace or None
        In and out in the plant's input's unit; None where there is no such resonance, or no room for the states.
    """
    modes = model.modes
    natural = np.sort(modes.frequency[(modes.damping > 0) & (modes.damping < mistuning)])
    if len(natural) == 0:
        return None
    groups = np.split(natural, 1 + np.flatnonzero(natural[1:] > (1.0 + 2.0 * mistuning) * natural[:-1]))
    chain = [
        _notch(min(float(frequency), 0.45 * model.rate), width, model.rate)
        for group in groups
        for frequency in ((1.0 - BESIDE) * group[0], (1.0 + BESIDE) * group[-1])
    ]
    if model.order + 2 * len(chain) > MOST_STATES:
        return None
    whole = chain[0]
    for each in chain[1:]:
        whole = whole.then(each)
    return whole


def behind(notch: StateSpace, model: InnovationModel) -> InnovationModel:
    """Return what a model of one input and output says of the plant with notches before it: their states come last."""
    plant, states = plant_of(model), len(notch.A)
    return replace(
        model,
        A=np.block([[plant.A, plant.B @ notch.C], [np.zeros((states, model.order)), notch.A]]),
        B=np.vstack([plant.B @ notch.D, notch.B]),
        C=np.hstack([plant.C, plant.D @ notch.C]),
        D=plant.D @ notch.D,
        K=np.vstack([model.K, np.zeros((states, 1))]),
    )


def with_notches(loop: StateFeedback, notch: StateSpace, model: InnovationModel) -> StateFeedback:
    """Return a loop that was made for the plant behind notches as one with the plant's own input.

    The notches' input is what that of the plant and their states say it was.  So they are states of the filter which
    the plant's input drives, and know of its limits (Hanus' conditioning).

    Parameters
    ----------
    loop : StateFeedback
        For `behind(notch, model)`.
    notch : StateSpace
    model : InnovationModel

    Returns
    -------
    StateFeedback
        Its model has the notches' states after the plant's; the output does not show them.

    Source
    ------
    Hanus, Kinnaert and Henrotte, Automatica 23 (1987) 729, for the limits.
    """
    n, states, through = model.order, len(notch.A), 1.0 / notch.D[0, 0]
    known = replace(
        model,
        A=np.block(
            [
                [model.A, np.zeros((n, states))],
                [np.zeros((states, n)), notch.A - through * notch.B @ notch.C],
            ]
        ),
        B=np.vstack([model.B, through * notch.B]),
        C=np.hstack([model.C, np.zeros((1, states))]),
        K=np.vstack([model.K, np.zeros((states, 1))]),
    )
    own = np.hstack([np.zeros((1, n)), notch.C])
    return StateFeedback(
        known,
        loop.gain,
        notch.D @ loop.feedback - own,
        loop.servo,
        notch.D @ loop.servo_feedback,
        float(notch.D[0, 0] * loop.forward),
    )


def _notch(frequency: float, width: float, rate: float) -> StateSpace:
    """Return a notch of a frequency (Hz) that passes what is far from it: Tustin, exact at its frequency."""
    turn = math.tan(math.pi * frequency / rate)

    def polynomial(damping: float) -> np.ndarray:
        return np.array([1 + 2 * damping * turn + turn**2, 2 * (turn**2 - 1), 1 - 2 * damping * turn + turn**2])

    zeros, poles = polynomial(DEPTH), polynomial(width)
    zeros, poles = zeros / poles[0], poles / poles[0]
    return StateSpace(
        np.array([[-poles[1], -poles[2]], [1.0, 0.0]]),
        np.array([[1.0], [0.0]]),
        (zeros - zeros[0] * poles)[None, 1:],
        zeros[:1, None],
    )
