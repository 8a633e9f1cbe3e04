"""Range, unit and type of a key in words."""

import pytest

from rigkit.allowed import field_at, limits, unit, wanted
from tests.rigkit.rig_file import Device, Filter, RigFile


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("rate", "a whole number >= 8000 and <= 192000 samples/s"),
        ("gain", "a number > 0 and < 10 V"),
        ("name", "text, not empty, at most 20 long"),
        ("channels", "a list of whole numbers, not empty"),
        ("band", "a list of 2 numbers in Hz"),
        ("mode", '"fast" or "slow"'),
        ("step", "1 or 4"),
        ("isolated", "true or false"),
        ("options", "a table"),
    ],
)
def test_all_that_a_key_may_hold_is_said(name: str, words: str) -> None:
    assert wanted(Device.model_fields[name]) == words


def test_a_key_without_range_and_unit_has_no_limits() -> None:
    assert limits(Device.model_fields["mode"]) == ""


def test_a_pure_number_has_no_unit() -> None:
    assert unit(Device.model_fields["step"]) == ""
    assert unit(Filter.model_fields["corner"]) == "Hz"


def test_a_path_is_followed_to_the_innermost_key() -> None:
    assert field_at(RigFile, ("device", "band", 0)) == (Device.model_fields["band"], ("device", "band"))
    assert field_at(RigFile, ("device", "filter", "corner")) == (
        Filter.model_fields["corner"],
        ("device", "filter", "corner"),
    )


def test_a_path_that_leaves_the_model_ends_where_it_leaves() -> None:
    assert field_at(RigFile, ("device", "nothing", "more")) == (None, ("device",))
