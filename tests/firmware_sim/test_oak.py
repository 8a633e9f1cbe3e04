"""Oak against what was published of it, and against (7.4)."""

from typing import Any

import numpy as np
import pytest

from firmware_sim.plants.oak import OakMilling
from firmware_sim.plants.oak_table import BETAS, PUBLISHED, WIDTHS

RATE = 2_000.0
PLAIN: dict[str, Any] = {"spread": 0.0, "knots": 0, "wear": 0.0, "length": 50e-3, "width": 40e-3}


def mill(oak: OakMilling, places: np.ndarray) -> dict[str, np.ndarray]:
    """Run the tool through places, shape (samples, 3), m."""
    widths = {"force": 3, "moment": 3, "teeth_force": 3, "kappa": 1, "beta": 1}
    found = {name: np.zeros((len(places), width)) for name, width in widths.items()}
    oak.run(places, *found.values())
    return found


def line(y: float, way: float, feed: float, length: float = 30e-3, z: float = -3e-3) -> np.ndarray:
    """Return places along x at a feed, m/s, about the middle; where way is -1, to the west."""
    x = way * (np.arange(round(length / feed * RATE)) * feed / RATE - 0.5 * length)
    return np.column_stack([x, np.full(len(x), y), np.full(len(x), z)])


def feed_of(way: int, column: int) -> float:
    """Return the feed, m/s, that Experiment 1 had in a type."""
    return 1.0 / (PUBLISHED[way][column] * WIDTHS[column])


@pytest.mark.parametrize("way", [0, 1])
@pytest.mark.parametrize(
    ("column", "beside"),
    [(0, 0.0), (1, 4e-3), (2, 2e-3), (3, -4e-3), (4, -2e-3)],
    ids=["slot", "2/3 up", "1/3 up", "2/3 down", "1/3 down"],
)
def test_the_published_feeds_meet_10_n(way: int, column: int, beside: float) -> None:
    """Material to the left of the feed is up milling; the walls of a slot are found to a few percent of a width."""
    oak, sign = OakMilling(RATE, **PLAIN), 1 - 2 * way
    if column:
        mill(oak, line(0.0, sign, 0.03, 40e-3))
    found = mill(oak, line(sign * beside, sign, feed_of(way, column)))
    force = found["force"][-200:].mean(axis=0)
    assert np.hypot(*force[:2]) == pytest.approx(10.0, rel=0.04)
    assert -sign * force[0] > 0.0
    assert sign * force[1] / abs(force[0]) == pytest.approx(BETAS[way][column], rel=0.1)
    assert found["beta"][-1, 0] == pytest.approx(BETAS[way][column], abs=0.06)


def test_the_force_rises_as_in_7_5() -> None:
    """K_f (p - kappa int f): the time constant is 1 / (K_f kappa)."""
    oak = OakMilling(RATE, **PLAIN)
    found = mill(oak, line(0.0, 1, 0.02))
    force, kappa = np.linalg.norm(found["force"], axis=1), found["kappa"][-1, 0]
    at = int(np.argmax(force > (1 - np.exp(-1.0)) * force[-1])) - int(np.argmax(force > 0.0))
    assert at / RATE == pytest.approx(1.0 / (150e3 * kappa), abs=0.6e-3)


def test_air_and_a_tool_above_the_wood_meet_nothing() -> None:
    oak = OakMilling(RATE, **PLAIN)
    assert not mill(oak, line(0.0, 1, 0.05, z=1e-3))["force"].any()
    mill(oak, line(0.0, 1, 0.02))
    again = mill(oak, line(0.0, 1, 0.05)[20:])["force"]
    assert np.abs(again[:500]).max() < 0.5


def test_a_tool_that_goes_back_meets_nothing_until_it_is_there_again() -> None:
    oak = OakMilling(RATE, **PLAIN)
    forth = line(0.0, 1, 0.02, 10e-3)
    mill(oak, forth)
    back = mill(oak, forth[::-1][:500])["force"]
    assert np.abs(back[20:]).max() < 0.5
    again = np.linalg.norm(mill(oak, forth[-500:])["force"], axis=1)
    assert again[:300].max() < 0.5


def test_the_force_grows_with_depth_with_the_fibres_turned_and_with_wear() -> None:
    plain = np.linalg.norm(mill(OakMilling(RATE, **PLAIN), line(0.0, 1, 0.02))["force"][-1])
    deep = np.linalg.norm(mill(OakMilling(RATE, **PLAIN), line(0.0, 1, 0.02, z=-6e-3))["force"][-1])
    assert deep == pytest.approx(2.0 * plain, rel=0.01)
    turned = line(0.0, 1, 0.02)[:, [1, 0, 2]]
    north = np.linalg.norm(mill(OakMilling(RATE, **PLAIN), turned)["force"][-1])
    slower = 0.5 * (PUBLISHED[0][0] + PUBLISHED[1][0]) / PUBLISHED[0][0]
    assert north == pytest.approx(1.2 * slower * plain, rel=0.02)
    worn = np.linalg.norm(mill(OakMilling(RATE, **PLAIN | {"wear": 10.0}), line(0.0, 1, 0.02))["force"][-1])
    assert worn == pytest.approx(1.3 * plain, rel=0.01)


def test_knots_and_grain_make_it_harder_here_than_there_and_are_drawn_by_the_seed() -> None:
    whole = line(0.0, 1, 0.02)
    forces = [
        np.linalg.norm(mill(OakMilling(RATE, **PLAIN | {"spread": 0.12, "seed": seed}), whole)["force"], axis=1)[200:]
        for seed in (1, 1, 2)
    ]
    np.testing.assert_array_equal(forces[0], forces[1])
    assert np.abs(forces[0] - forces[2]).max() > 0.5
    assert 0.02 < forces[0].std() / forces[0].mean() < 0.3
    knotty = OakMilling(RATE, **PLAIN | {"knots": 40})
    assert np.linalg.norm(mill(knotty, whole)["force"], axis=1).max() > 1.4 * forces[0].mean()


def test_what_is_left_is_the_wood_beside_the_tool() -> None:
    oak = OakMilling(RATE, **PLAIN)
    before = (oak.left > 0.0).sum()
    mill(oak, line(0.0, 1, 0.02))
    gone = (before - (oak.left > 0.0).sum()) * 1e-8
    assert gone == pytest.approx(30e-3 * 6e-3 + np.pi * 3e-3**2, rel=0.02)
    assert oak.milled == pytest.approx(30e-3, rel=0.01)


def test_teeth_are_felt_about_the_mean_force() -> None:
    found = mill(OakMilling(RATE, **PLAIN), line(0.0, 1, 0.02))
    teeth, mean = found["teeth_force"][-1200:, 0], found["force"][-1200:, 0]
    assert teeth.mean() == pytest.approx(mean.mean(), rel=0.02)
    assert teeth.std() == pytest.approx(np.hypot(0.6, 0.15) / np.sqrt(2) * abs(mean.mean()), rel=0.05)


@pytest.mark.parametrize(
    ("options", "text"),
    [({"knot": 0.5}, "knot is 0.5, must be 1 to 10"), ({"origin": (0.0, 0.0)}, "origin is .* must be 3 numbers, m")],
)
def test_an_option_out_of_its_range_is_refused_by_name(options: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        OakMilling(RATE, **options)


def test_another_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="rate is 250 samples/s, must be 500 to 100000"):
        OakMilling(250)
