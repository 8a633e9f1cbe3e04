"""Who may clear what has latched, and when."""

import pytest

from rigkit.latch import to_clear


def test_a_person_clears_what_has_latched_and_hears_why() -> None:
    assert to_clear("the guard", "too loud", "Ada") == "too loud"


@pytest.mark.parametrize(
    ("cause", "by", "still", "text"),
    [
        ("too loud", " ", "", "the guard is cleared by ' ', must be a person's name"),
        (None, "Ada", "", "the guard is not latched, Ada has nothing to clear"),
        ("", "Ada", "", "the guard is not latched, Ada has nothing to clear"),
        ("too loud", "Ada", "fades to zero", "the guard still fades to zero, Ada must clear it after that"),
    ],
)
def test_nobody_nothing_and_too_early_are_refused(cause: str | None, by: str, still: str, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        to_clear("the guard", cause, by, still)
