"""Learning to mill as an experiment: each trial a part, whose path follows from those before."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ctlblocks.room import bytes_of
from rigkit.experiment.kept import early_facts
from rigkit.experiment.kind import Records
from rigkit.experiment.part import Part
from rigkit.experiment.runner import never
from rigkit.report import Fact
from stagectl.experiments.trials.bench import Bench, SimulatedBench
from stagectl.experiments.trials.campaign import grouped, learn, names_of
from stagectl.experiments.trials.done import DoneTrial, trials_in
from stagectl.experiments.trials.laws import Learner
from stagectl.experiments.trials.log_folder import write_logs
from stagectl.experiments.trials.report import figures, trial_report
from stagectl.experiments.trials.runner import summary
from stagectl.experiments.trials.surroundings import recorded, simulated
from stagectl.experiments.trials.trial import Trial
from stagectl.experiments.trials.trial_graph import TrialGraph
from stagectl.link.tell import Tell, nobody

PAGE, LOGS = "report.html", "logs"
REFUSED = "refused"
"""The event of a method that is refused where there are others; among the figures, why, by method."""
_LOGS = 2
"""Times the room that recordings take, with the logs that are written of them."""


class Milling:
    """A path learned in free space, then in material, by one method or by several.

    Parameters
    ----------
    first : Trial
        The path as it is wanted, in the air.
    methods : sequence of int
    iterations : int
        Trials in material after the first one, of each method.
    learner : Learner or None
        Without one nothing is run.
    bench : Bench
    done : mapping of str to DoneTrial, optional
        Trials that have come to their end, by name: these are not run again.
    reasons : mapping of str to str, optional
        Why trials ended before their end, by name: these are learned from and judged by nobody.
    say : callable(str)
        Told a line of each trial.
    refused : mapping of str to str, optional
        Why methods were refused, by number.
    """

    def __init__(
        self,
        first: Trial,
        methods: Sequence[int] = (),
        iterations: int = 0,
        learner: Learner | None = None,
        bench: Bench | None = None,
        done: Mapping[str, DoneTrial] | None = None,
        reasons: Mapping[str, str] | None = None,
        say: Callable[[str], object] = lambda _: None,
        refused: Mapping[str, str] | None = None,
    ) -> None:
        self.first, self.methods, self.iterations = first, tuple(methods), iterations
        self._learner, self._bench = learner, bench or SimulatedBench()
        self._done, self._reasons, self._say = dict(done or {}), dict(reasons or {}), say
        self._refused = dict(refused or {})

    @property
    def done(self) -> list[DoneTrial]:
        """The trials that are not run again."""
        return sorted(self._done.values(), key=lambda each: each.trial.number)

    @property
    def names(self) -> list[str]:
        """Of all trials, in order."""
        return names_of(self.first.cell.learning.free, self.methods, self.iterations)

    @property
    def left(self) -> list[str]:
        """Names of the trials that have not been run."""
        return [name for name in self.names if name not in self._done]

    @property
    def seconds(self) -> float:
        """Of the trials that are left."""
        return len(self.left) * self.first.path.seconds

    @property
    def about(self) -> dict[str, str]:
        """Provenance of the recordings."""
        return {"cell": "simulated" if isinstance(self._bench, SimulatedBench) else "live"}

    @property
    def designed(self) -> dict[str, Any]:
        """What is asked for."""
        return {"methods": list(self.methods), "iterations": self.iterations, "live": self.about["cell"] == "live"}

    @property
    def room(self) -> int:
        """Bytes that the trials that are left may take, with their logs."""
        return room(self.first, len(self.left))

    def parts(self, tell: Tell = nobody, stopped: Callable[[], bool] = never) -> Iterator[Part]:
        """Give a part for each trial that is left, once it is known from those before which path is sent.

        Raises
        ------
        ValueError : a law that may diverge, a path that is refused, a signal that is missing.
        LinkError, Stopped : as of the bench.
        """
        assert self._learner is not None
        self._learner.note, self._learner.leave_out = self._noting(tell), self._leaving_out(tell)
        steps, came = learn(self.first, self._learner, self.methods, self.iterations), None
        while True:
            try:
                name, trial = next(steps) if came is None else steps.send(came)
            except StopIteration:
                break
            came = self._done.get(name)
            if came is not None:
                continue
            with self._bench.part(name, trial, tell, stopped) as part:
                kept = part.in_memory("kept")
                yield part
            records = {track.removeprefix(f"{name}-"): record for track, record in kept().items()}
            came = DoneTrial(name, trial, records)
            if trial.zero is not None:
                self._say(summary(came))
        self._bench.leave(tell, stopped)

    def _noting(self, tell: Tell) -> Callable[[str], object]:
        def note(text: str) -> None:
            tell("turned_back", {"text": text})
            self._say(text)

        return note

    def _leaving_out(self, tell: Tell) -> Callable[[int, str], object]:
        def leave_out(method: int, why: str) -> None:
            tell(REFUSED, {"method": method, "text": why})
            self._say(f"method {method} is refused: {why}")

        return leave_out

    def again(self, records: Records) -> Iterator[Part]:
        """Give a part for each trial that is recorded, its sensors as they were."""
        for each in trials_in(records, self.first):
            yield TrialGraph(each.name, each.trial, nobody, recorded(each.records)).part_again(each.left)

    def whole(self, records: Records) -> list[DoneTrial]:
        """Return the trials that came to their end."""
        return [each for each in trials_in(records, self.first) if not self._reasons.get(each.name)]

    def figures(self, records: Records) -> dict[str, Any]:
        """Return the errors of each trial that came to its end, m: in the air, and by method; methods refused."""
        if not (whole := self.whole(records)):
            raise ValueError("no trial has ended")
        return {**figures(*grouped(whole)), REFUSED: self._refused}

    def report(self, path: Path, records: Records, figures: Mapping[str, Any], png: Path | None) -> None:
        """Write the report, and of each trial its logs as other robots' are read."""
        whole = self.whole(records)
        made = trial_report(*grouped(whole), path)
        left = (Fact(f"Refused, method {each}", why, passed=False) for each, why in self._refused.items())
        made = replace(made, facts=(*made.facts, *left, *early_facts(figures)))
        made.write(path / PAGE)
        if png is not None:
            made.png(png)
        for each in whole:
            if not (path / LOGS / each.name).exists():
                write_logs(path / LOGS / each.name, each)


def room(first: Trial, trials: int) -> int:
    """Return the bytes that so many trials of a path may take, with logs that are as long again.

    Parameters
    ----------
    first : Trial
    trials : int
    """
    graph = TrialGraph("trial", first, nobody, simulated)
    ticks, found = graph.part().ticks, 0
    for track in graph.tracks():
        found += bytes_of(ticks // track.every, len(track.names(graph.graph)), "float64", "wav")
    return _LOGS * found * trials
