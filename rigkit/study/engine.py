"""Runs a study: tasks in the order of seeds, by whatever performs them, until all are done or the budget is spent."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from time import monotonic
from typing import Protocol

from rigkit.progress import Meter
from rigkit.provenance import software
from rigkit.stop import StopRequest
from rigkit.study.folder import StudyFolder
from rigkit.study.outcome import REFUSED, Outcome
from rigkit.study.results import Row
from rigkit.study.task import Task

HOUR = 3600.0
BATCH_SECONDS = 10.0
"""After so long a batch is written, however small: what a kill of the whole program may cost."""
_POLL = 0.2
"""s between looks at whether the person has asked to stop."""


class Hands(Protocol):
    """What performs tasks: workers on this machine, or those of a cluster."""

    @property
    def executor(self) -> Executor:
        """Takes tasks, as many at once as `slots` says."""

    @property
    def perform(self) -> Callable[[Task], Outcome]:
        """What it calls."""

    @property
    def lost(self) -> tuple[type[BaseException], ...]:
        """What a task ends with that is begun again, since whoever performed it has died."""

    @property
    def slots(self) -> int:
        """How many tasks are given to it at once."""


@dataclass
class Tally:
    """How far a study is.

    Parameters
    ----------
    total : int
        Tasks in all, if the budget lasts.
    done, refused, failed : int
        Tasks: with any outcome; refused; with any other status but 0.
    cpu : float, h
        Spent.
    """

    total: int
    done: int = 0
    refused: int = 0
    failed: int = 0
    cpu: float = 0.0

    def count(self, status: int, cpu: float) -> None:
        """Count one task; `cpu` in s."""
        self.done += 1
        self.refused += status == REFUSED
        self.failed += status not in (0, REFUSED)
        self.cpu += cpu / HOUR

    def share(self, budget: float) -> float:
        """Return how much is done, of 1; `budget` in h, 0 for none."""
        return max(self.done / self.total, self.cpu / budget if budget > 0 else 0.0)

    @property
    def text(self) -> str:
        """It in words."""
        others = [f"{number} {name}" for number, name in ((self.refused, "refused"), (self.failed, "failed")) if number]
        return ", ".join([f"{self.done} of {self.total} tasks", *others, f"{self.cpu:.2f} h of processor time"])


class Study:
    """A study in its folder.

    Parameters
    ----------
    folder : StudyFolder
    """

    def __init__(self, folder: StudyFolder) -> None:
        self.folder, self.plan = folder, folder.plan
        self.budget = self.plan.study.budget.cpu_hours
        self._stored = {row.key for row in folder.rows()}
        self.tally = Tally(self.plan.count)
        for row in folder.rows():
            self.tally.count(row.status, row.cpu)
        self._software = software()
        self._batch: list[Row] = []
        self._written = monotonic()
        self._noted: set[str] = set()

    @property
    def is_spent(self) -> bool:
        """Whether no new seed is to be begun."""
        return 0 < self.budget <= self.tally.cpu

    def run(self, hands: Hands, meter: Meter, stop: StopRequest) -> None:
        """Perform what is still to be done; returns early where a stop is asked for."""
        try:
            for task, outcome in self._outcomes(hands, stop):
                self._take(task, outcome, meter)
        finally:
            self._write()
        if not stop.made:
            self.folder.finish()

    def _tasks(self) -> Iterator[Task]:
        """Yield what is still to be done; a seed that is begun is ended, whatever the budget."""
        for seed in self.plan.seeds():
            missing = [task for task in seed if task.key not in self._stored]
            if missing and self.is_spent and len(missing) == len(seed):
                continue
            yield from missing

    def _outcomes(self, hands: Hands, stop: StopRequest) -> Iterator[tuple[Task, Outcome]]:
        tasks, pending = self._tasks(), dict[Future[Outcome], Task]()
        is_over = False
        while not stop.made:
            while not is_over and len(pending) < hands.slots:
                task = next(tasks, None)
                is_over = task is None
                if task is not None:
                    pending[hands.executor.submit(hands.perform, task)] = task
            if not pending:
                return
            done, _ = wait(pending, _POLL, FIRST_COMPLETED)
            for future in done:
                task = pending.pop(future)
                outcome = _result(future, task, hands.lost)
                if outcome is None:
                    pending[hands.executor.submit(hands.perform, task)] = task
                else:
                    yield task, outcome

    def _take(self, task: Task, outcome: Outcome, meter: Meter) -> None:
        if outcome.software != self._software:
            raise ValueError(f"{outcome.host}: its worker is {outcome.software}, must be {self._software}")
        row = Row.of(task, outcome, self.plan.figures, self.plan.inputs_of(task.machine))
        self._batch.append(row)
        self.tally.count(row.status, row.cpu)
        for note in outcome.notes:
            if note not in self._noted:
                meter.say(f"{task.folder}: {note}")
        self._noted |= set(outcome.notes)
        if monotonic() - self._written > BATCH_SECONDS:
            self._write()
        meter.show(self.tally.share(self.budget), self.tally.text)

    def _write(self) -> None:
        if self._batch:
            self.folder.write(self._batch)
        self._batch, self._written = [], monotonic()


def cores() -> int:
    """Return how many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _result(future: Future[Outcome], task: Task, lost: tuple[type[BaseException], ...]) -> Outcome | None:
    """Return what came of a task, None where whoever performed it has died."""
    try:
        return future.result()
    except lost:
        return None
    except CancelledError:
        raise ValueError(f"{task.folder}: the workers are gone; the same command continues") from None
