"""What a rig file, a model and a reference make together: everything a run, its replay and its report start from."""

from dataclasses import dataclass

import numpy as np

from vibractl.algorithm import Algorithm
from vibractl.config import RigConfig
from vibractl.law import Law, learning_law
from vibractl.learner import Learner, Timeline, timeline
from vibractl.reference import Reference, reference_from
from vibractl.spectrum import load_wisdom, save_wisdom, user_wisdom
from vibractl.transfer_matrix import TransferMatrix

LEAST_WITHIN = 0.99
"""Part of a reference's energy that the learned lines must hold."""


@dataclass(frozen=True)
class Setup:
    """A run before its first shot.

    Parameters
    ----------
    config : RigConfig
    reference : Reference, as wide as the accelerometers controlled
    law : Law
    shot : Timeline
    """

    config: RigConfig
    reference: Reference
    law: Law
    shot: Timeline

    def algorithm(self) -> Algorithm:
        """Return the learning at its first drive."""
        config = self.config
        return Algorithm(self.law, config.adaptation, config.watch, config.quality.objective)

    def learner(self) -> Learner:
        """Return a learner at its first drive."""
        config = self.config
        responses = len(config.audio.response_channels)
        edge = config.limits.ramp
        if self.reference.root is not None:  # the overtones rise and fall with the root
            edge = max(edge, self.reference.taper * self.shot.frames / self.shot.rate)
        return Learner(self.algorithm(), self.shot, config.learning.decimation, edge, responses)


def setup(config: RigConfig, matrix: TransferMatrix, fresh_plans: bool = True) -> Setup:
    """Put a run together.

    Parameters
    ----------
    config : RigConfig
    matrix : TransferMatrix, of the rig
    fresh_plans : bool
        Take this user's FFT plans and keep new ones for the next time; False leaves those that are loaded.

    Raises
    ------
    ValueError : the reference, the model and the settings do not fit together.
    """
    if fresh_plans:
        load_wisdom(user_wisdom())
    controlled = 1 if config.learning.side else len(config.audio.response_channels)
    reference = reference_from(
        config.reference.signal,
        config.audio.rate,
        config.reference.amplitude,
        config.reference.taper,
        controlled,
        config.learning.decimation,
    )
    if reference.root is not None and 2 * reference.root > min(config.learning.band[1], config.quality.judged_to):
        raise ValueError(
            f"reference {reference.text}: no overtone of {reference.root:g} Hz lies within learning.band and "
            "below quality.judged_to"
        )
    _refuse_beyond_band(reference, config)
    law = learning_law(config.learning, matrix, reference, config.audio.rate)
    made = Setup(config, reference, law, timeline(config, len(reference.signal)))
    made.learner()  # plans its transforms, so that they can be kept
    if fresh_plans:
        save_wisdom(user_wisdom())
    return made


def _refuse_beyond_band(reference: Reference, config: RigConfig) -> None:
    energy = (np.abs(np.fft.rfft(reference.signal, axis=0)) ** 2).sum(axis=1)
    frequency = np.fft.rfftfreq(len(reference.signal), 1 / config.audio.rate)
    low, high = config.learning.band
    within = float(energy[(frequency >= low) & (frequency <= high)].sum() / energy.sum())
    if within < LEAST_WITHIN:
        raise ValueError(
            f"reference {reference.text}: learning.band, {low:g} to {high:g} Hz, holds {100 * within:.1f} % of its "
            f"energy, must hold {100 * LEAST_WITHIN:g} %"
        )
