"""What a shot is judged by: the reference, where it lies in a shot, and what hears it; no model is needed."""

from dataclasses import dataclass, field
from typing import Protocol

from vibractl.config import RigConfig
from vibractl.fft_plans import Plans
from vibractl.learner import Timeline, timeline
from vibractl.place import Place, at_accelerometers
from vibractl.reference import Reference
from vibractl.setup import reference_of, transformed_by
from vibractl.spectrum import Decimator


class Judged(Protocol):
    """What a judge must know of a shot."""

    @property
    def config(self) -> RigConfig:
        """The rig."""

    @property
    def reference(self) -> Reference:
        """As wide as the accelerometers controlled."""

    @property
    def shot(self) -> Timeline:
        """Where it lies."""

    @property
    def places(self) -> tuple[Place, ...]:
        """Where shots are judged; at the accelerometers first."""

    @property
    def plans(self) -> Plans:
        """By which it is transformed."""


@dataclass(frozen=True)
class Judging:
    """A shot of anybody's, to be judged.

    Parameters
    ----------
    config : RigConfig
    reference : Reference, as wide as the accelerometers controlled
    shot : Timeline
    places : tuple of Place
        The accelerometers.
    plans : Plans
    """

    config: RigConfig
    reference: Reference
    shot: Timeline
    places: tuple[Place, ...]
    plans: Plans = field(default_factory=Plans)

    @property
    def judged(self) -> Place:
        """Where the objective must hold."""
        return self.places[0]

    @property
    def coils(self) -> tuple[int, ...]:
        """Coils that are driven, counted from 0."""
        side, drives = self.config.learning.side, len(self.config.audio.drive_channels)
        return (side - 1,) if side else tuple(range(drives))

    @classmethod
    def of(cls, config: RigConfig) -> "Judging":
        """Return what shots of a rig are judged by, with the reference that its settings ask for.

        Raises
        ------
        ValueError : the reference cannot be made.
        """
        reference = reference_of(config)
        side, sensors = config.learning.side, len(config.audio.response_channels)
        outputs = (side - 1,) if side else tuple(range(sensors))
        if not max(outputs) < sensors:
            raise ValueError(f"learning.side is {side}, must be 1 to {sensors}, or 0")
        near = at_accelerometers(Decimator(config.learning.decimation).apply(reference.signal), outputs)
        plans = Plans(backend=config.spectrum.backend)
        return cls(transformed_by(plans, config), reference, timeline(config, reference), (near,), plans)
