"""Trials one by one into a folder, for who needs each before it knows the next; one that is there is read."""

from collections.abc import Callable

from rigkit.experiment.kept import records_of
from rigkit.experiment.once import Once
from rigkit.experiment.runner import Conduct
from rigkit.run_folder import RunFolder
from stagectl.experiments.trials.bench import Bench
from stagectl.experiments.trials.done import BESIDE, DoneTrial, done_trial
from stagectl.experiments.trials.trial import Trial


class Runner:
    """Runs trials into a folder.

    Parameters
    ----------
    folder : RunFolder
    bench : Bench
    conduct : Conduct
    say : callable(str)
        Told a line of each trial.
    """

    def __init__(
        self, folder: RunFolder, bench: Bench, conduct: Conduct, say: Callable[[str], object] = lambda _: None
    ) -> None:
        self.folder, self._bench, self._conduct, self._say = folder, bench, conduct, say
        self._once = Once(folder, conduct, trial_of)

    def has(self, name: str) -> bool:
        """Whether a trial of that name has come to its end."""
        return (self.folder.path / f"{name}-{BESIDE}.csv").is_file() or self._once.has(name)

    def __call__(self, name: str, trial: Trial) -> DoneTrial:
        """Run a trial, recorded as it goes; or read it.

        Raises
        ------
        Stopped, PartEnded : a person, or a fault, ended it; what was recorded until then is kept.
        ValueError, LinkError : as of the bench, before it begins.
        """
        if self.has(name):
            return self._read(name, trial)
        self._once.run(name, self._bench.part(name, trial, self.folder.event, self._conduct.stopped))
        done = self._read(name, trial)
        if trial.zero is not None and trial.path.milled.any():
            self._say(summary(done))
        return done

    def _read(self, name: str, trial: Trial) -> DoneTrial:
        return done_trial(name, records_of(self.folder.path, f"{name}-"), trial)


def summary(done: DoneTrial) -> str:
    """Return a trial's errors in a line."""
    size = 1e6 * done.mae
    return f"{done.name}: MAE x {size[0]:.0f}, y {size[1]:.0f}, z {size[2]:.0f} µm"


def trial_of(track: str) -> str:
    """Return the name of the trial that a recording is of."""
    return track.rpartition("-")[0]
