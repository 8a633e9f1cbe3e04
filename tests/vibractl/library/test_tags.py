"""Tags: what is one, and how far two sets of them are apart."""

import pytest

from vibractl.library.tags import distances, parsed


@pytest.mark.parametrize("text", ["depth", "=10", "depth=", "1st=2", "de pth=1", "a=" + "x" * 81, "depth=a\nb"])
def test_what_is_no_tag_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is not key=value"):
        parsed([text])


def test_a_tag_that_is_not_finite_or_given_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="tag 'depth=nan': nan is not finite"):
        parsed(["depth=nan"])
    with pytest.raises(ValueError, match="tag depth is given twice, 1 and 2"):
        parsed(["depth=1", "depth=2"])


def test_a_value_may_hold_an_equals_sign() -> None:
    assert parsed(["note=a=b"]) == {"note": "a=b"}


def test_numbers_count_by_their_difference_over_the_spread_of_the_library() -> None:
    held = [{"depth": "10"}, {"depth": "30"}, {"depth": "15"}]
    assert distances({"depth": "20"}, held) == [0.5, 0.5, 0.25]


def test_a_number_written_another_way_is_the_same() -> None:
    assert distances({"depth": "10.0"}, [{"depth": "10"}]) == [0.0]


def test_a_text_counts_by_being_the_same_and_a_missing_tag_as_far() -> None:
    held = [{"place": "tank"}, {"place": "sea"}, {}, {"place": "7"}]
    assert distances({"place": "sea"}, held) == [1.0, 0.0, 1.0, 1.0]
    assert distances({"place": "8"}, held) == [1.0, 1.0, 1.0, 1.0]


def test_tags_that_are_not_asked_for_do_not_count() -> None:
    assert distances({}, [{"depth": "10"}, {}]) == [0.0, 0.0]


def test_the_distances_of_several_tags_add_up() -> None:
    held = [{"depth": "10", "place": "tank"}, {"depth": "20", "place": "sea"}]
    assert distances({"depth": "10", "place": "sea"}, held) == [1.0, 1.0]
