"""A planner beside the tick: late, failing, or wrong, the tool goes on in the default order, and it is reported."""

import subprocess
import sys
from collections.abc import Mapping
from threading import Event
from typing import Any

import pytest

from stagectl.planning.beside import PlannerBeside
from stagectl.planning.milling import Milled, finished, mill
from stagectl.planning.pocket import check, planner
from stagectl.planning.problem import Pocket
from stagectl.planning.strips import Cut, Standing, costs, untouched
from stagectl.planning.zigzag import ZigzagPlanner
from tests.stagectl.planning.pockets import EXAMPLE

POCKET = Pocket.from_dict(EXAMPLE)
WRONG = ((9, 1), (0, 4), (0, 0), None, "E3", (0, 3, 1))


class _Scripted:
    """The exact planner but for one call: of the strip after `at` segments it does as it is told."""

    def __init__(self, at: int, gives: object = None, raises: Exception | None = None) -> None:
        self._within, self._at, self._gives, self._raises = planner("exact", POCKET), at, gives, raises
        self.learned: list[Milled] = []

    def choose(self, standing: Standing) -> Cut:
        if len(self.learned) == self._at:
            if self._raises is not None:
                raise self._raises
            return self._gives  # type: ignore[return-value]  # what a planner must not do
        return self._within.choose(standing)

    def learn(self, milled: Milled) -> None:
        self.learned.append(milled)


class _Held:
    """A planner that waits in its `choose` until it is let go, from the second call on."""

    def __init__(self) -> None:
        self._within, self._calls = planner("exact", POCKET), 0
        self.go = Event()

    def choose(self, standing: Standing) -> Cut:
        self._calls += 1
        if self._calls > 1:
            self.go.wait()
        return self._within.choose(standing)

    def learn(self, milled: Milled) -> None:
        self._within.learn(milled)


class _Heard:
    """Keeps the events."""

    def __init__(self) -> None:
        self.events: list[Mapping[str, Any]] = []

    def __call__(self, event: str, fields: Mapping[str, Any]) -> None:
        assert event == "planner"
        self.events.append(fields)


def _complete(segments: list[Milled]) -> bool:
    return check(POCKET, [each.in_path for each in segments]).complete


def test_waited_for_it_mills_what_the_planner_mills_alone() -> None:
    heard = _Heard()
    with PlannerBeside(planner("exact", POCKET), POCKET, heard, patience=None) as beside:
        both = [mill(POCKET, beside) for _ in range(2)]
    assert both[0] == both[1] == mill(POCKET, planner("exact", POCKET))
    assert not any(beside.counts().values())
    assert heard.events == []


def test_a_late_planner_leaves_the_default_order_which_is_reported_and_counted() -> None:
    held, heard = _Held(), _Heard()
    with PlannerBeside(held, POCKET, heard, patience=0.0) as beside:
        segments = mill(POCKET, beside)
        held.go.set()
    rest = iter(segments[1:])
    default = ZigzagPlanner(POCKET)
    assert all(each.cut == default.choose(each.standing) for each in rest)
    assert _complete(segments)
    assert beside.counts()["planned_late"] == len(segments) - 1
    assert [each["segment"] for each in heard.events] == list(range(2, len(segments) + 1))
    assert {each["reason"] for each in heard.events} == {"late"}
    assert heard.events[0]["chosen"] == segments[1].name


def test_a_choice_made_ahead_is_taken_where_the_newest_is_late() -> None:
    held, heard = _Held(), _Heard()
    with PlannerBeside(held, POCKET, heard, patience=60.0) as beside:
        standing, cost = untouched(POCKET), costs(POCKET)
        first = finished(beside.choose(standing), standing, cost)
        held.go.set()
        ahead = beside._ahead  # noqa: SLF001 (it is waited for here, as a strip is milled meanwhile)
        assert ahead is not None
        expected = ahead.result(60.0)
        held.go.clear()
        beside.learn(first)
        beside.patience = 0.0
        assert beside.choose(first.leaves()) == expected
        held.go.set()
    assert beside.counts()["planned_ahead"] == 1
    assert heard.events == []


@pytest.mark.parametrize("fault", [ValueError("no way"), StopIteration(), TimeoutError("own"), MemoryError()])
def test_a_planner_that_raises_leaves_the_default_order_for_one_strip(fault: Exception) -> None:
    heard = _Heard()
    with PlannerBeside(_Scripted(2, raises=fault), POCKET, heard, patience=None) as beside:
        segments = mill(POCKET, beside)
    assert _complete(segments)
    assert segments[2].cut == ZigzagPlanner(POCKET).choose(segments[2].standing)
    (event,) = heard.events
    assert event == {"segment": 3, "reason": f"raised {type(fault).__name__}: {fault}", "chosen": segments[2].name}
    assert beside.counts()["planner_failed"] == 1


@pytest.mark.parametrize("wrong", WRONG, ids=str)
def test_a_strip_that_is_not_legal_is_not_milled(wrong: object) -> None:
    heard = _Heard()
    with PlannerBeside(_Scripted(1, gives=wrong), POCKET, heard, patience=None) as beside:
        segments = mill(POCKET, beside)
    assert _complete(segments)
    (event,) = heard.events
    assert event["reason"] == f"chose {wrong!r}, must be a legal strip"
    assert beside.counts()["planner_failed"] == 1


def test_what_is_wrong_with_the_first_strip_is_raised_before_anything_moves() -> None:
    with (
        PlannerBeside(_Scripted(0, gives=(9, 9)), POCKET, _Heard()) as beside,
        pytest.raises(ValueError, match=r"the planner chose \(9, 9\), must be a legal strip"),
    ):
        beside.choose(untouched(POCKET))


def test_a_segment_that_is_not_learned_is_reported_and_the_planner_goes_on() -> None:
    class Forgetful(_Scripted):
        def learn(self, milled: Milled) -> None:
            super().learn(milled)
            if len(self.learned) == 3:
                raise RuntimeError("full")

    heard = _Heard()
    with PlannerBeside(Forgetful(99), POCKET, heard, patience=None) as beside:
        segments = mill(POCKET, beside)
    assert segments == mill(POCKET, planner("exact", POCKET))
    assert heard.events == [{"segment": 3, "reason": "learned nothing, raised RuntimeError: full"}]
    assert beside.counts()["not_learned"] == 1


def test_no_thread_is_left_at_the_end() -> None:
    with PlannerBeside(planner("exact", POCKET), POCKET, _Heard()) as beside:
        beside.choose(untouched(POCKET))
    assert not beside._thread.is_alive()  # noqa: SLF001


def test_an_end_in_the_midst_of_a_decision_does_not_wait_for_it_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stagectl.planning.beside.LAST", 0.01)
    held = _Held()
    with PlannerBeside(held, POCKET, _Heard()) as beside:
        beside.choose(untouched(POCKET))
    assert beside._thread.daemon  # noqa: SLF001 (it dies with the program)
    held.go.set()


HUNG = """
from stagectl.planning import beside
from stagectl.planning.strips import untouched
from tests.stagectl.planning.test_beside import POCKET, _Held, _Heard

beside.LAST = 0.01
with beside.PlannerBeside(_Held(), POCKET, _Heard()) as planner:
    planner.choose(untouched(POCKET))
"""
"""A program whose planner is at work for ever."""


def test_a_planner_at_work_does_not_keep_the_program_from_its_end() -> None:
    assert subprocess.run([sys.executable, "-c", HUNG], timeout=60.0, check=False).returncode == 0


def test_the_default_order_goes_back_and_forth_off_one_side_in_strips_as_wide_as_can_be() -> None:
    names = [each.name for each in mill(POCKET, ZigzagPlanner(POCKET))]
    assert names == ["E3", "W3"] * 5
    thin = Pocket(7, 30, 3, "EW", POCKET.rate)
    segments = mill(thin, ZigzagPlanner(thin))
    assert [each.name for each in segments] == ["E3", "W3", "E1d"]
    assert {each.cut.side for each in segments} == {"N"}
