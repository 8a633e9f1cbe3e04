"""Random streams by name."""

import numpy as np
import pytest

from firmware_sim.population.streams import Streams

FIRST = [0.21040967524647447, 0.678286879629415, 0.4776703660396059]


def test_a_stream_is_the_same_on_every_machine() -> None:
    """By numbers that stand here: PCG64 and SeedSequence are fixed by numpy's policy (NEP 19), our hash by SHA-256."""
    drawn = Streams(7, "vibrator", "lumped")("mass").random(3)
    np.testing.assert_array_equal(drawn, FIRST)


def test_a_stream_is_named_by_all_names_on_the_way_to_it() -> None:
    streams = Streams(7, "vibrator")
    numbers = [
        each.random()
        for each in (
            streams("mass"),
            streams("spring"),
            streams.within("lumped")("mass"),
            Streams(7, "stage")("mass"),
            Streams(8, "vibrator")("mass"),
        )
    ]
    assert len(set(numbers)) == 5


def test_drawing_from_one_stream_leaves_the_others_as_they_were() -> None:
    streams = Streams(7, "vibrator")
    before = streams("mass").random()
    streams("spring").random(1000)
    assert streams("mass").random() == before


@pytest.mark.parametrize("seed", [-1, 1.0, True, "7"])
def test_a_seed_that_is_none_is_refused(seed: object) -> None:
    with pytest.raises(ValueError, match="must be a whole number >= 0"):
        Streams(seed)  # type: ignore[arg-type]
