"""The events of the cell's runs are told in sentences."""

from typing import Any

from stagectl.experiments.toroid.event_text import event_text

COUNTS = {"received": 796, "lost": 3, "late": 0, "unseen": 1}


def told(event: str, **fields: Any) -> str:
    return event_text({"time": "2026-11-22T07:33:38.444+00:00", "event": event, **fields})


def test_an_end_says_why_and_what_the_tracker_missed() -> None:
    tracker = {"spindle": COUNTS, "workpiece": {"received": 5, "lost": 0}}
    assert told("ended", setup="B", seconds=1.82, reason="", tracker=tracker) == (
        "Setup B, after 1.82 s, without a fault. Of the spindle 796 samples came: 3 lost, 1 unseen. "
        "Of the workpiece 5 samples came."
    )
    text = told("ended", setup="C", seconds=3.0, reason="the tracker is blind", tracker={}, samples_at_end=1)
    assert (
        text
        == "Setup C, after 3 s, held: the tracker is blind. The stage was asked beyond its travel in 1 sample of 4 ms."
    )


def test_a_start_says_what_was_started_and_a_fault_what_held_it() -> None:
    assert told("started", setup="A", software="vibrostage 0.1.0") == "Setup A, robot alone, with vibrostage 0.1.0."
    assert told("robot_fault", reason="the robot's motors are off") == "Held: the robot's motors are off."


def test_other_events_are_told_with_their_particulars() -> None:
    assert told("acknowledged", by="A. Person") == "by A. Person"
