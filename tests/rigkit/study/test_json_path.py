"""One value out of JSON by its path."""

import pytest

from rigkit.study.json_path import reduced, value_at

TOLD = {"axes": [{"fit": 0.9, "by": {"a.b": None}}, {"fit": 0.8}], "met": 4, "none": []}


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("met", 4),
        ("axes[-1].fit", 0.8),
        ("axes[*].fit", [0.9, 0.8]),
        ('axes[0].by."a.b"', None),
        ("none[*].fit", []),
        ("[*]", [*TOLD.values()]),
    ],
)
def test_a_path_leads_to_its_value(path: str, value: object) -> None:
    assert value_at(TOLD, path) == value


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("mat", "it has no mat; there are axes, met, none"),
        ("axes[2]", "axes has no item 2"),
        ("axes[1].by", "axes\\[1\\] has no by; there are fit"),
        ("met[*]", "met is no list and no object"),
        ("met.x", "met has no x"),
    ],
)
def test_a_path_that_leads_nowhere_says_where_it_ends(path: str, said: str) -> None:
    with pytest.raises(LookupError, match=said):
        value_at(TOLD, path)


@pytest.mark.parametrize(
    ("how", "value"), [("min", 1), ("max", 4), ("mean", 2.5), ("first", 1), ("last", 4), ("count", 2)]
)
def test_many_values_become_one_and_null_is_none_of_them(how: str, value: float) -> None:
    assert reduced([1, None, [4]], how) == value


def test_of_no_values_there_is_none_and_their_count_is_zero() -> None:
    assert reduced([None], "mean") is None
    assert reduced([], "count") == 0
