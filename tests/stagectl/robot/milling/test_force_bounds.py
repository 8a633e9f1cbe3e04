"""Bounds of forces with slack: those of linear programming, and of corners by hand; the true force is between them."""

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stagectl.robot.milling import force_box_kernel as boxes
from stagectl.robot.milling.force_estimate import estimate_force
from tests.stagectl.robot.milling.force_cases import NOISE, Cases, extremes, random_cases

SLACK = 3 * NOISE + 0.3


def widened(cases: Cases, slack: np.ndarray) -> Cases:
    return replace(cases, friction=cases.friction + np.stack([-slack, slack], axis=1))


def slack_of(cases: Cases) -> np.ndarray:
    return np.tile(SLACK, (len(cases.torque), 1))


@pytest.mark.sample(2)
@pytest.mark.parametrize("tie_break", ["centre", "minimum-norm"])
@pytest.mark.parametrize("reach", [1.0, 1.2])
@pytest.mark.slow
def test_bounds_are_those_of_linear_programming_over_wider_ranges(reach: float, tie_break: str) -> None:
    """Where some force is in them; noise is none of (5.6)'s any more, so nothing is taken off the torques."""
    cases = random_cases(30, reach, seed=8)
    slack = slack_of(cases)
    found = estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance, tie_break, slack)
    quiet = estimate_force(cases.torque, cases.jacobian, widened(cases, slack).friction, cases.covariance)
    fits = np.flatnonzero(quiet.objective == 0)
    assert len(fits) > 20
    for n in fits:
        expected = extremes(widened(cases, slack), n, np.zeros(6), 1e-9)
        expected = np.minimum(expected[0], found.force[n]), np.maximum(expected[1], found.force[n])
        assert np.array([found.low[n], found.high[n]]) == pytest.approx(np.array(expected), abs=1e-5)


def test_bounds_are_those_of_the_corners_of_the_set() -> None:
    """Every corner is where three faces meet: 160 of them, of which those in all slabs are the set's."""
    cases = random_cases(10, 1.0, seed=9)
    slack = slack_of(cases)
    found = estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance, slack=slack)
    wide = widened(cases, slack)
    for n in range(10):
        lever, bound = -cases.jacobian[n].T, cases.torque[n] - wide.friction[n]
        corners = []
        for three in map(list, combinations(range(6), 3)):
            for side in product((0, 1), repeat=3):
                corner = np.linalg.solve(lever[three], bound[list(side), three])
                friction = cases.torque[n] - lever @ corner
                if (friction >= wide.friction[n, 0] - 1e-8).all() and (friction <= wide.friction[n, 1] + 1e-8).all():
                    corners.append(corner)
        assert found.low[n] == pytest.approx(np.min(corners, axis=0), abs=1e-5)
        assert found.high[n] == pytest.approx(np.max(corners, axis=0), abs=1e-5)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    excess=st.lists(st.floats(-1, 1), min_size=6, max_size=6),
    tie_break=st.sampled_from(["centre", "minimum-norm"]),
)
def test_the_true_force_is_in_bounds_whatever_slack_allows(seed: int, excess: list[float], tie_break: str) -> None:
    """Friction at the ends of its ranges, and beside it as much as slack allows, with any signs."""
    cases, rng = random_cases(20, 1.0, seed), np.random.default_rng(seed)
    ends = np.where(rng.random((20, 6)) < 0.5, cases.friction[:, 0], cases.friction[:, 1])
    torque = ends - np.einsum("nij,ni->nj", cases.jacobian, cases.force) + SLACK * np.array(excess)
    found = estimate_force(torque, cases.jacobian, cases.friction, cases.covariance, tie_break, slack_of(cases))
    rounding = 1e-6 * (1 + np.abs(found.high - found.low))
    assert (found.low <= cases.force + rounding).all()
    assert (cases.force - rounding <= found.high).all()


@pytest.mark.parametrize("reach", [1.0, 1.5, 4.0])
def test_slack_changes_neither_estimate_nor_objective_nor_whether_it_is_one(reach: float) -> None:
    cases = random_cases(300, reach, seed=10)
    given_ = cases.torque, cases.jacobian, cases.friction, cases.covariance
    for tie_break in ("centre", "minimum-norm"):
        plain = estimate_force(*given_, tie_break)
        found = estimate_force(*given_, tie_break, slack_of(cases))
        assert (found.force == plain.force).all()
        assert (found.objective == plain.objective).all()
        assert (found.unique == plain.unique).all()
        assert (found.low <= found.force).all()
        assert (found.force <= found.high).all()
        widths = found.high - found.low, plain.high - plain.low
        assert np.median(widths[0]) > np.median(widths[1])


def test_a_torque_beyond_all_slack_has_bounds_about_what_noise_leaves() -> None:
    """A hundred newton metres too much on one joint: nothing fits, and bounds still hold the estimate."""
    cases = random_cases(50, 1.0, seed=11)
    torque = cases.torque.copy()
    torque[:, 5] += 100.0
    found = estimate_force(torque, cases.jacobian, cases.friction, cases.covariance, slack=slack_of(cases))
    assert (found.objective > 0).all()
    assert np.isfinite(found.low).all()
    assert (found.high - found.low > 0.5).all()


def test_slabs_that_rounding_could_confuse_have_their_box() -> None:
    """Levers along the axes, twice: corners with more than three faces, and zeros in every ratio."""
    slab = np.vstack([np.eye(3), 0.5 * np.eye(3)])
    middle = np.array([1.0, -2.0, 3.0, 0.5, -1.0, 1.5])
    low, high = np.zeros((2, 3))
    assert boxes.search_box(middle, slab, np.ones(6), low, high, np.zeros((boxes.PARTS, 6))) == boxes.FOUND
    assert low == pytest.approx([0.0, -3.0, 2.0])
    assert high == pytest.approx([2.0, -1.0, 4.0])
    middle[3] = 9.0
    assert boxes.search_box(middle, slab, np.ones(6), low, high, np.zeros((boxes.PARTS, 6))) == boxes.EMPTY


@pytest.mark.parametrize(
    ("slack", "said"),
    [
        (np.ones(6), r"slack has shape \(6,\), must be \(2, 6\)"),
        (-np.ones((2, 6)), "slack is -1 N m, must be >= 0"),
        (np.full((2, 6), np.nan), "slack is nan N m, must be >= 0"),
    ],
)
def test_slack_that_is_none_is_refused(slack: np.ndarray, said: str) -> None:
    cases = random_cases(2, 1.0)
    with pytest.raises(ValueError, match=said):
        estimate_force(cases.torque, cases.jacobian, cases.friction, cases.covariance, slack=slack)
