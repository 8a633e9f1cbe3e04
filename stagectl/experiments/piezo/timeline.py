"""When what happens in a run, in samples."""

from dataclasses import dataclass

from stagectl.config import StageConfig


@dataclass(frozen=True)
class Timeline:
    """A run: the voltages rise to rest, the controllers start, the run proper begins and ends, voltages go to rest.

    Parameters
    ----------
    rate : float, samples/s
    start, begin, end, total : int, samples
        Of the controllers, of the run proper, its end, and how many there are in all.
    """

    rate: float
    start: int
    begin: int
    end: int
    total: int

    @property
    def proper(self) -> slice:
        """The samples that are judged."""
        return slice(self.begin, self.end)


def timeline(config: StageConfig) -> Timeline:
    """Return the timeline of a rig file."""
    rate, ramp = config.stage.rate, config.limits.ramp
    begin = round(config.session.lead * rate)
    end = begin + round(config.session.seconds * rate)
    return Timeline(rate, round(ramp * rate) + 2, begin, end, end + round(1.1 * ramp * rate))
