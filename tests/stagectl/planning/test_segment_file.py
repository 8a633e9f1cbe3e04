"""Segments that were written are read again, and a planner learns from them."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from stagectl.planning.milling import Milled, mill
from stagectl.planning.pocket import MAKERS, PLANNERS, planner, untrained
from stagectl.planning.problem import Pocket, PocketFault
from stagectl.planning.segment_file import read_segments, write_segments
from stagectl.planning.sequential import SequentialPlanner
from tests.stagectl.planning.pockets import EXAMPLE

POCKET = Pocket.from_dict(EXAMPLE)


def _felt(segment: Milled) -> Milled:
    return replace(segment, force_deviation=1.5 if segment.cut.k == 3 else math.nan)


def test_what_was_recorded_is_learned(tmp_path: Path) -> None:
    first = SequentialPlanner(POCKET, {})
    write_segments(tmp_path / "segments.csv", [mill(POCKET, first, _felt), mill(POCKET, first, _felt)])
    second = SequentialPlanner(POCKET, {})
    for segment in read_segments(tmp_path / "segments.csv", POCKET):
        second.learn(segment)
    for name, known in first.sets.items():
        assert second.sets[name].rates == pytest.approx(known.rates)
        assert second.sets[name].forces == pytest.approx(known.forces, nan_ok=True)
    assert mill(POCKET, second) == mill(POCKET, first)


def test_each_planner_that_is_named_can_be_made() -> None:
    assert tuple(MAKERS) == PLANNERS


@pytest.mark.parametrize("name", PLANNERS)
def test_every_planner_learns_from_what_somebody_recorded(tmp_path: Path, name: str) -> None:
    """A slot to the east that takes forever is not planned."""
    (tmp_path / "segments.csv").write_text("type,side,cells,duration\n" + "E3,N,20,9\nE3,S,20,9\n" * 2)
    made = planner(name, replace(POCKET, closed=False))
    for segment in read_segments(tmp_path / "segments.csv", POCKET):
        made.learn(segment)
    assert "E3" not in {each.name for each in mill(replace(POCKET, closed=False), made)}


def test_a_planner_that_trains_itself_needs_less_after_it_has_read(tmp_path: Path) -> None:
    first = untrained("uncertain", POCKET)
    write_segments(tmp_path / "segments.csv", [mill(POCKET, first) for _ in range(3)])
    second = untrained("uncertain", POCKET)
    for segment in read_segments(tmp_path / "segments.csv", POCKET):
        second.learn(segment)
    assert mill(POCKET, second)[0].cut == mill(POCKET, first)[0].cut


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("type,side,duration\n", "there is no column cells, must have type, side, cells, duration"),
        ("", "there is no column type, side, cells, duration"),
        ("type,side,cells,duration\nE4,N,3,1\n", "line 2: type is 'E4', must be of E3"),
        ("type,side,cells,duration\nE3,N,3,1\nE2u,N,3,1\n", "line 3: side is 'N', must be one off which E2u is milled"),
        ("type,side,cells,duration\nE3,N,3,-1\n", "line 2: duration is '-1', must be a number > 0"),
        ("type,side,cells,duration\nE3,N,3,nan\n", "line 2: duration is 'nan', must be a number > 0"),
        ("type,side,cells,duration\nE3,N,2.5,1\n", "line 2: cells is 2.5, must be a whole number"),
        ("type,side,cells,duration\nE3,N\n", "line 2: cells is None, must be a number > 0"),
        ("type,side,cells,duration\nE3,N,3,0.5\n", "line 2: duration is 0.5 s, must be > t_acc, 0.5 s"),
    ],
)
def test_a_file_that_says_nothing_is_refused_by_line(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "segments.csv").write_text(text)
    with pytest.raises(PocketFault) as fault:
        read_segments(tmp_path / "segments.csv", replace(POCKET, t_acc=0.5))
    assert said in str(fault.value)
