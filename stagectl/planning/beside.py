"""A planner in a thread beside the tick: the next strip is chosen while the present one is milled."""

from collections.abc import Callable, Mapping
from concurrent.futures import Future, wait
from contextlib import suppress
from functools import partial
from queue import SimpleQueue
from threading import Thread
from types import TracebackType
from typing import Any, Self

from stagectl.planning.milling import Milled, Planner
from stagectl.planning.problem import Pocket, shortened
from stagectl.planning.strips import NO_WAY, Cut, Standing, after, costs, legal
from stagectl.planning.zigzag import ZigzagPlanner

PATIENCE = 1e-3
"""s for which a tick waits for a choice; the robot's silence limit is 12 ms."""
LAST = 5.0
"""s for which the end of a run waits for a planner that is at work; its thread dies with the program."""
_LATE = "late"

Hear = Callable[[str, Mapping[str, Any]], object]
"""Takes an event and its fields."""


class PlannerBeside:
    """A planner that chooses in a thread of its own, and never fails: it is a `Planner` itself.

    When a segment begins, the strip after it is chosen ahead.  When it is finished, the planner learns from it and
    chooses again; the newest choice is taken if it is there within `patience`, else the one made ahead, else the
    default order, `ZigzagPlanner`, goes on.  The default order goes on as well where the planner raises, or chooses a
    strip that is not legal.  Each of that is counted, and all but a choice made ahead is reported as an event `planner`
    by the thread.

    Before the first segment nothing moves: the planner is waited for, and what it raises is raised.

    Parameters
    ----------
    planner : Planner
        Called by the thread alone while that runs.
    pocket : Pocket
    hear : callable(event, fields)
        Receives the events; it may write to a file.
    patience : float, s, or None
        None waits for as long as a choice takes, and nothing is chosen ahead: the same run gives the same strips.
    """

    def __init__(self, planner: Planner, pocket: Pocket, hear: Hear, patience: float | None = PATIENCE) -> None:
        self.patience = patience
        self._planner, self._pocket, self._hear = planner, pocket, hear
        self._costs, self._default = costs(pocket), ZigzagPlanner(pocket)
        self._work: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._thread = Thread(target=self._run, name="planner", daemon=True)
        self._segment = 0
        self._ahead: Future[Cut] | None = None
        self._counts = {"planned_ahead": 0, "planned_late": 0, "planner_failed": 0, "not_learned": 0}

    def __enter__(self) -> Self:
        """Start the thread."""
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, _: TracebackType | None) -> None:
        """End the thread once it has learned what is to be learned; leave one that is at work for longer."""
        self._forget(self._ahead)
        self._work.put(None)
        self._thread.join(LAST)

    def counts(self) -> dict[str, int]:
        """Return how many strips were chosen ahead, late, or not at all, and how many segments were not learned."""
        return dict(self._counts)

    def choose(self, standing: Standing) -> Cut:
        """Return the strip to mill next; before the first segment, raise what the planner raises."""
        if standing.way == NO_WAY:
            self._segment, cut = 1, self._first(standing)
        else:
            self._segment += 1
            cut = self._next(standing)
        following = after(cut, standing)
        self._ahead = None if following.is_done or self.patience is None else self._ask(following)
        return cut

    def learn(self, milled: Milled) -> None:
        """Have the thread tell the planner of a finished segment."""
        self._work.put(partial(self._learn, self._segment, milled))

    def _first(self, standing: Standing) -> Cut:
        self._forget(self._ahead)
        cut, why = self._legal(self._ask(standing).result(), standing)
        if cut is None:
            raise ValueError(f"the planner {why}")
        return cut

    def _next(self, standing: Standing) -> Cut:
        newest, ahead = self._ask(standing), self._ahead
        cut, why = self._answer(newest, standing, self.patience)
        if why == _LATE and ahead is not None:
            cut, why = self._answer(ahead, standing, 0.0)
            self._counts["planned_ahead"] += cut is not None
        self._forget(newest)
        self._forget(ahead)
        if cut is None:
            cut = self._default.choose(standing)
            self._counts["planned_late" if why == _LATE else "planner_failed"] += 1
            self._report(self._segment, why, cut.name(self._pocket.G))
        return cut

    def _answer(self, asked: "Future[Cut]", standing: Standing, patience: float | None) -> tuple[Cut | None, str]:
        """Return what the planner has chosen, or None and why that is not to be milled."""
        if not wait([asked], patience).done:
            return None, _LATE
        try:
            return self._legal(asked.result(), standing)
        except Exception as fault:  # whatever a planner raises, the tool goes on
            return None, f"raised {type(fault).__name__}: {fault}"

    def _legal(self, given: object, standing: Standing) -> tuple[Cut | None, str]:
        cuts = legal(standing, self._costs) if isinstance(given, tuple) else ()
        cut = next((each for each in cuts if each == given), None)
        return cut, "" if cut is not None else f"chose {shortened(given)}, must be a legal strip"

    @staticmethod
    def _forget(asked: "Future[Cut] | None") -> None:
        if asked is not None:
            asked.cancel()

    def _ask(self, standing: Standing) -> "Future[Cut]":
        asked: Future[Cut] = Future()
        self._work.put(partial(self._choose, asked, standing))
        return asked

    def _report(self, segment: int, why: str, chosen: str) -> None:
        fields = {"segment": segment, "reason": why, "chosen": chosen}
        self._work.put(partial(self._hear, "planner", fields))

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            with suppress(OSError):  # a full disk is reported by who records
                work()

    def _choose(self, asked: "Future[Cut]", standing: Standing) -> None:
        if asked.set_running_or_notify_cancel():
            try:
                asked.set_result(self._planner.choose(standing))
            except Exception as fault:  # raised where the choice is taken
                asked.set_exception(fault)

    def _learn(self, segment: int, milled: Milled) -> None:
        try:
            self._planner.learn(milled)
        except Exception as fault:  # the planner goes on with what it knows
            self._counts["not_learned"] += 1
            reason = f"learned nothing, raised {type(fault).__name__}: {fault}"
            self._hear("planner", {"segment": segment, "reason": reason})
