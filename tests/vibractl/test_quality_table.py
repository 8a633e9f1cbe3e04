"""What a run's end says of the change that its model does not explain."""

from typing import Any

import pytest

from vibractl.quality_table import floor_said


@pytest.mark.parametrize(
    ("figures", "said"),
    [
        ({}, "change of the plant"),
        ({"floor_explained_db": 9.0}, "what the model does not explain changes by"),  # the drive still changes more
        ({"worst_line_db": 30.0}, "what the model does not explain changes by"),  # nor is that what stands in the way
        ({"floor_db": 51.0, "worst_line_db": 38.0}, "what the model does not explain changes by"),  # it diverges
        ({"floor_explained_db": None}, "what the model does not explain changes by"),  # a run of an earlier version
        (
            {"floor_db": -20.0, "floor_explained_db": -30.0, "worst_line_db": -3.0},
            "change of the plant",
        ),
        ({"shots_hidden": 6}, ""),
        ({"floor_db": None}, ""),
    ],
)
def test_the_machine_is_named_only_where_the_run_has_come_as_far_as_it_lets_it(
    figures: dict[str, Any], said: str
) -> None:
    settled = {"floor_db": 3.0, "floor_hz": 210.0, "floor_explained_db": 0.0, "worst_line_db": 8.0}
    what, size = floor_said({"shots": 10, "shots_hidden": 1, **settled, **figures})
    assert what == said
    assert bool(size) == bool(said)
