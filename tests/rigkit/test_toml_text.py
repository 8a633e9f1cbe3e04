"""TOML text of single values and keys."""

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigkit.toml_text import key_text, value_text


@pytest.mark.parametrize(
    "value", [True, -3, 1e-05, 1e22, -0.0, 5e-324, [1, [2.5, "x"]], {"a b": {"c": []}}, "é\x7f\x00\n"]
)
def test_a_value_is_read_back(value: object) -> None:
    assert repr(tomllib.loads(f"value = {value_text(value)}")["value"]) == repr(value)


def test_a_tuple_is_written_as_an_array() -> None:
    assert value_text((1, 2.0)) == "[1, 2.0]"


@given(st.lists(st.text(), min_size=1, max_size=3))
def test_a_dotted_key_leads_back_to_its_names(names: list[str]) -> None:
    level = tomllib.loads(f"{key_text(*names)} = 1")
    for name in names:
        level = level[name]
    assert level == 1
