"""A run's events as a table of its report."""

from rigkit.event_table import event_table

EVENT = {"time": "2026-11-21T13:23:37.198+00:00", "event": "discarded", "shot": 4, "rms": 0.1 + 0.2, "reason": "a slip"}


def test_an_event_is_told_with_its_particulars() -> None:
    table = event_table([EVENT])
    assert table.rows == (("2026-11-21 13:23:37", "discarded", "shot 4, rms 0.3, reason a slip"),)


def test_an_event_is_told_in_the_words_of_those_who_know_it() -> None:
    assert event_table([EVENT], lambda event: f"Shot {event['shot']}.").rows[0][2] == "Shot 4."
