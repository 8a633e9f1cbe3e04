"""Gains of the update, in stages."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Gains:
    """K(k) in stages: `stages[i]` updates with `gains[i]`, and the last gain ever after.

    Parameters
    ----------
    gains : floats, 1, each 0 to 1
    stages : ints, updates, one fewer than the gains

    Raises
    ------
    ValueError : the numbers do not fit, or a gain is outside 0 to 1.

    Source
    ------
    Sörnmo 2015, eq. (6.11), (6.24), (6.25).

    Examples
    --------
    >>> [Gains((0.3, 0.15), (15,)).at(k) for k in (0, 14, 15)]
    [0.3, 0.3, 0.15]
    """

    gains: tuple[float, ...]
    stages: tuple[int, ...]

    def __post_init__(self) -> None:
        """Check that stages and gains fit."""
        if len(self.gains) != len(self.stages) + 1:
            raise ValueError(
                f"learning.stages has {len(self.stages)} stages for {len(self.gains)} gains, must have one fewer"
            )
        for gain in self.gains:
            if not 0 <= gain <= 1:
                raise ValueError(f"learning.gains has {gain!r}, must be 0 to 1")
        for stage in self.stages:
            if stage < 1:
                raise ValueError(f"learning.stages has {stage!r}, must be >= 1 shots")

    def at(self, shot: int) -> float:
        """Return K for the update after shot `shot`, the first being 0."""
        for gain, stage in zip(self.gains, self.stages, strict=False):
            if shot < stage:
                return gain
            shot -= stage
        return self.gains[-1]


SINE_GAINS = Gains((1.0, 0.25), (12,))
"""Sörnmo 2015, eq. (6.24)."""
CHIRP_GAINS = Gains((0.3, 0.15), (15,))
"""Sörnmo 2015, eq. (6.25)."""
KALMAN_GAINS = Gains((0.8, 0.4), (7,))
"""Where the model follows the plant, and so may be trusted with more."""
