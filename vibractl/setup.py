"""What a rig file, a model and a reference make together: everything a run, its replay and its report start from."""

from dataclasses import dataclass, field

import numpy as np

from vibractl.config import RigConfig
from vibractl.far_field import FarField
from vibractl.fft_plans import Plans
from vibractl.fft_transform import Transform
from vibractl.guard import Violation, violation
from vibractl.learner import Learner, Timeline, silences, timeline
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.edges import with_edges
from vibractl.learning.far_field_law import far_field_law, shared_text
from vibractl.learning.law import Law
from vibractl.learning.law_of_run import learning_law
from vibractl.learning.warm_start import KnownDrive
from vibractl.library.entry import Entry
from vibractl.library.fit import misfit
from vibractl.mains import NOMINAL, PIECE, Mains
from vibractl.place import Place, Where, at_accelerometers, in_far_field
from vibractl.reference import Reference, reference_from
from vibractl.spectrum import Decimator
from vibractl.spectrum_config import Spectrum
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
    places : tuple of Place
        Where shots are judged: at the accelerometers, and in the far field where that is known.
    known : KnownDrive or None
        What is checked first, and started from if it fits.
    plans : Plans
        By which everything of this run is transformed.
    said : tuple of str
        What a person should know of how its parts differ, a line each.
    """

    config: RigConfig
    reference: Reference
    law: Law
    shot: Timeline
    places: tuple[Place, ...]
    known: KnownDrive | None = None
    plans: Plans = field(default_factory=Plans)
    said: tuple[str, ...] = ()

    @property
    def coils(self) -> tuple[int, ...]:
        """Coils that are driven, counted from 0."""
        return tuple(np.flatnonzero(np.any(self.law.spread != 0, axis=1)).tolist())

    @property
    def judged(self) -> Place:
        """Where the objective must hold."""
        return self._place(self.config.quality.where)

    @property
    def learned(self) -> Place:
        """Whose errors are learned from."""
        return self._place(self.config.learning.sensors)

    @property
    def note(self) -> str:
        """What a person should know before the run; empty for nothing."""
        return shared_text(self.law, len(self.learned.sensors)) if self.learned.is_far else ""

    def algorithm(self) -> Algorithm:
        """Return the learning at its first drive."""
        config = self.config
        rising = judged_lines(self.law, self.reference, config) if config.learning.quiet else None
        return Algorithm(self.law, config.adaptation, config.watch, config.quality.objective, self.known, rising)

    def learner(self) -> Learner:
        """Return a learner at its first drive."""
        config = self.config
        responses = len(config.audio.response_channels)
        step = config.learning.decimation
        mains = self.mains(self.learned)
        return Learner(self.algorithm(), self.shot, step, responses, self.learned, self.plans, mains, config.limits)

    def mains(self, place: Place) -> Mains | None:
        """Return what follows the mains' hum at a place; None where it is not to be, or no silence follows a shot."""
        if not self.config.quality.mains:
            return None
        step, shot = self.config.learning.decimation, self.shot
        lead, tail, rate = shot.lead // step, shot.after // step - max(place.late), shot.rate / step
        if tail < PIECE * rate:
            return None
        highest = max(self.config.learning.band[1], self.config.quality.judged_to)
        return Mains(lead, tail, shot.total // step, rate, min(highest, rate / 2 - NOMINAL[-1]))

    def _place(self, where: Where) -> Place:
        return next(place for place in self.places if place.name == where)


def reference_of(config: RigConfig) -> Reference:
    """Make the reference that the settings ask for, as wide as the accelerometers controlled.

    The silence after it is part of it: until then the vibrator is to have come to rest.  Of a sine, only the steady
    state counts.
    """
    controlled = 1 if config.learning.side else len(config.audio.response_channels)
    reference = reference_from(
        config.reference.signal,
        config.audio.rate,
        config.reference.amplitude,
        config.reference.taper,
        controlled,
        config.learning.decimation,
        config.reference.full_scale,
    )
    return reference if reference.root is not None else reference.with_rest(silences(config)[1])


def transforms(config: RigConfig, frames: int) -> tuple[Transform, ...]:
    """Return the sizes of all FFTs that a run makes by its plans.

    Parameters
    ----------
    config : RigConfig
    frames : int, samples, of the reference
    """
    learning, audio = config.learning, config.audio
    controlled = 1 if learning.side else len(audio.response_channels)
    driven = 1 if learning.side or learning.structure == "common" else len(audio.drive_channels)
    learned = frames // learning.decimation
    sizes = [Transform(learned, controlled), Transform(frames, driven)]
    if audio.far_field_channels:
        sizes.append(Transform(learned, len(audio.far_field_channels)))
    return tuple(dict.fromkeys(sizes))


def judged_lines(law: Law, reference: Reference, config: RigConfig) -> np.ndarray:
    """Return which learned lines the objective holds for, bool (lines,): those above the root, for a sine."""
    quality, frequency = config.quality, law.matrix.frequency
    judged: np.ndarray = (law.active > 0) & (frequency <= quality.judged_to)
    if reference.root is not None:
        return judged & (frequency > 1.5 * reference.root)
    return judged & (frequency >= quality.above)


def _drive_edges(config: RigConfig, reference: Reference) -> tuple[float, float]:
    """Return the length of the edges of a learned drive, and of its rest, s: a sine's has at least its taper."""
    if reference.root is None:
        return config.limits.ramp, 0.5 * reference.rest / config.audio.rate
    taper = reference.taper * len(reference.signal) / config.audio.rate
    return max(config.limits.ramp, taper), 0.0  # the overtones rise and fall with the root


def _importance(law: Law, reference: Reference, config: RigConfig) -> np.ndarray:
    """Return how much each line counts, (lines,), 1: one that is judged by as much as it is to be fainter."""
    importance: np.ndarray = np.where(judged_lines(law, reference, config), 10 ** (-config.quality.objective / 20), 1.0)
    return importance


def setup(
    config: RigConfig,
    matrix: TransferMatrix,
    far: FarField | None = None,
    entry: Entry | None = None,
    plans: Plans | None = None,
) -> Setup:
    """Put a run together.

    Parameters
    ----------
    config : RigConfig
    matrix : TransferMatrix, of the rig
    far : FarField, optional
        Of the rig's hydrophones.
    entry : Entry, optional
        Of the library, to be started from; for `learning.start = "library"`.
    plans : Plans, optional
        FFT plans to go by; all are estimated without them.

    Raises
    ------
    ValueError : the reference, the model and the settings do not fit together.
    """
    plans = plans or Plans(backend=config.spectrum.backend)
    config = transformed_by(plans, config)
    reference = reference_of(config)
    if reference.root is not None and 2 * reference.root > min(config.learning.band[1], config.quality.judged_to):
        raise ValueError(
            f"reference {reference.text}: no overtone of {reference.root:g} Hz lies within learning.band and "
            "below quality.judged_to"
        )
    _refuse_beyond_band(reference, config)
    law = learning_law(config.learning, matrix, reference, config.audio.rate, plans)
    places = _places(config, reference, law, far)
    if config.learning.sensors == "far-field" and far is not None:
        law = far_field_law(law, matrix, far, places[1], config.audio.rate / config.learning.decimation, plans)
    law = with_edges(law, *_drive_edges(config, reference), _importance(law, reference, config))
    known = _known_drive(entry, law, reference, config)
    for transform in transforms(config, len(reference.signal)):
        plans.planned(transform)  # all of them now, so that they can be stored before the first shot
    return Setup(config, reference, law, timeline(config, reference), places, known, plans)


def warm_setup(
    config: RigConfig, matrix: TransferMatrix, far: FarField | None, entry: Entry, plans: Plans
) -> tuple[Setup, Violation | None]:
    """Put a run together that starts from an entry of the library.

    Parameters
    ----------
    config : RigConfig
    matrix : TransferMatrix, of the rig
    far : FarField, optional
    entry : Entry
    plans : Plans

    Returns
    -------
    Setup
        As without the entry where its drive breaks a limit of the guard.
    Violation or None
        That limit.

    Raises
    ------
    ValueError : as for `setup`, or the entry does not fit.
    """
    made = setup(_starting(config, "library"), matrix, far, entry, plans)
    broken = violation(made.learner().rendered(entry.drive), config.limits, config.audio.rate)
    if broken is None:
        return made, None
    start = config.learning.start
    return setup(_starting(config, "by-law" if start == "library" else start), matrix, far, plans=plans), broken


def transformed_by(plans: Plans, config: RigConfig) -> RigConfig:
    """Return settings that name the library by which a run is transformed, so that its folder says it."""
    return config.model_copy(update={"spectrum": Spectrum(backend=plans.library)})


def _starting(config: RigConfig, start: str) -> RigConfig:
    return config.model_copy(update={"learning": config.learning.model_copy(update={"start": start})})


def _known_drive(entry: Entry | None, law: Law, reference: Reference, config: RigConfig) -> KnownDrive | None:
    if (entry is not None) != (config.learning.start == "library"):
        raise ValueError(
            f"learning.start is {config.learning.start!r}, and {'no' if entry is None else 'an'} entry of the library "
            "is given: a run starts from one with `vibractl run --warm nearest` or `--warm NAME`"
        )
    if entry is None:
        return None
    lines = law.matrix.frequency
    reason = misfit(entry, config, reference)
    if not reason and (entry.model.shape != law.matrix.response.shape or not np.allclose(entry.frequency, lines)):
        reason = f"of a model of shape {entry.model.shape}, this one's is {law.matrix.response.shape}"
    if reason:
        raise ValueError(f"library entry {entry.name} is {reason}")
    judged = judged_lines(law, reference, config)
    return KnownDrive(entry.name, entry.drive, entry.response, entry.model, judged, config.learning.check_levels)


def _places(config: RigConfig, reference: Reference, law: Law, far: FarField | None) -> tuple[Place, ...]:
    near = at_accelerometers(Decimator(config.learning.decimation).apply(reference.signal), law.outputs)
    if far is not None and config.audio.far_field_channels:
        rate = config.audio.rate / config.learning.decimation
        return near, in_far_field(near, far, rate, law.matrix.frequency, config.shot.tail)
    if config.quality.where == "far-field":
        raise ValueError("quality.where is far-field, but the model was measured without hydrophones; calibrate again")
    return (near,)


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
