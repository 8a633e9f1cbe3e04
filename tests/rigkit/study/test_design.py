"""Cases: grids, Latin hypercubes and lists."""

import numpy as np
import pytest

from rigkit.config import ConfigError
from rigkit.study.design import cases
from rigkit.study.file import Settings


def test_a_grid_is_every_combination() -> None:
    made = cases(Settings(values={"a": [1, 2], "b": ["x", "y", "z"]}))
    assert len(made) == 6
    assert made[1] == {"a": 1, "b": "y"}


def test_without_settings_there_is_one_case() -> None:
    assert cases(Settings()) == [{}]


def test_a_hypercube_has_a_point_in_each_of_as_many_strips_of_every_key() -> None:
    ranges = {
        "gain": {"low": 0.01, "high": 100.0, "log": True},
        "taps": {"low": 3, "high": 12, "whole": True},
        "law": ["a", "b"],
        "noise": {"low": -60.0, "high": -40.0},
    }
    made = cases(Settings(method="latin", points=20, seed=3, values=ranges))
    strips = np.floor(20 * (np.log10([case["gain"] for case in made]) + 2) / 4)
    assert sorted(strips) == list(range(20))
    assert sorted(np.floor([case["noise"] + 60 for case in made])) == list(range(20))
    assert [case["law"] for case in made].count("a") == 10
    assert all(sum(case["taps"] == taps for case in made) == 2 for taps in range(3, 13))
    assert made == cases(Settings(method="latin", points=20, seed=3, values=ranges))
    assert made != cases(Settings(method="latin", points=20, seed=4, values=ranges))


def test_a_list_is_as_it_stands() -> None:
    assert cases(Settings(method="list", cases=({"a": 1}, {"a": 5}))) == [{"a": 1}, {"a": 5}]


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (Settings(method="list"), "settings.cases is"),
        (Settings(method="list", cases=({"a": 1}, {"b": 5})), "must have the same keys"),
        (Settings(cases=({"a": 1},)), "settings.cases is given"),
        (Settings(method="latin"), "must hold at least one key"),
        (Settings(method="latin", values={"a": {"low": 2, "high": 1}}), "must have low < high"),
        (Settings(method="latin", values={"a": {"low": 0, "high": 1, "log": True}}), "low > 0 with log"),
        (Settings(method="latin", values={"a": {"lo": 0}}), "has no lo; did you mean low"),
        (Settings(values={"a": {"low": 0, "high": 1}}), "must be a list of values"),
    ],
)
def test_what_gives_no_cases_is_refused(settings: Settings, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        cases(settings)
