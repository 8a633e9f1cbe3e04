"""What was measured held against what models make of it: right ones pass, wrong ones are refused by their reason."""

from dataclasses import replace

import numpy as np
import pytest

from stagectl.robot.milling.agreement import agreement
from stagectl.robot.milling.axis_model import robot_response
from stagectl.robot.milling.witness import (
    refuse_other_axes,
    refuse_other_compliance,
    refuse_other_force,
    refuse_other_robot,
)
from stagectl.robot.milling.zero_phase import filtered
from tests.stagectl.robot.milling.test_milling_models import models

RATE = 250.0
AXES = models().robot["motors"].axes


def wandering(size: float, seed: int = 1) -> np.ndarray:
    """Return a slow path that rests at its ends, shape (2500, 3), of that rms."""
    drawn = np.cumsum(np.random.default_rng(seed).standard_normal((2_500, 3)), axis=0)
    slow = filtered(drawn - drawn[:1], RATE, lambda f: np.exp(-((f / 1.5) ** 2))[:, None, None] * np.eye(3))
    slow = (slow - slow.mean(axis=0)) * np.hanning(2_500)[:, None]
    return np.asarray(size * slow / slow.std(axis=0))


@pytest.fixture(scope="module")
def sent() -> np.ndarray:
    return wandering(5e-3)


@pytest.fixture(scope="module")
def joints(sent: np.ndarray) -> np.ndarray:
    noise = 1e-5 * np.random.default_rng(2).standard_normal(sent.shape)
    return filtered(sent, RATE, lambda frequency: robot_response(AXES, frequency)) + noise


def test_a_slope_is_that_of_what_is_common() -> None:
    foreseen, other = wandering(1.0), wandering(1.0, 5)
    found = agreement(2.0 * foreseen + 0.1 * other, foreseen, RATE)
    assert found.slope == pytest.approx(2.0, abs=0.1)
    assert found.correlation > 0.99
    assert abs(agreement(other, foreseen, RATE).correlation) < 0.5


def test_the_robot_s_own_model_passes_and_others_do_not(sent: np.ndarray, joints: np.ndarray) -> None:
    refuse_other_robot(sent, joints, AXES, "free-0")
    for factor in (3.0, 1.5, 0.7, -1.0):
        wrong = (*AXES[:2], replace(AXES[2], numerator=factor * np.asarray(AXES[2].numerator)))
        with pytest.raises(ValueError, match=f"free-0: along z the motors went {1 / factor:.3g} times"):
            refuse_other_robot(sent, joints, wrong, "free-0")


def test_a_tracker_in_other_units_or_axes_is_refused(joints: np.ndarray) -> None:
    seen = joints + wandering(1e-4, 3)
    refuse_other_axes(seen, joints, RATE, "tracker.csv")
    with pytest.raises(ValueError, match=r"tracker.csv: x goes 9[89][0-9] times as far .*; is it in m\?"):
        refuse_other_axes(1e3 * seen, joints, RATE, "tracker.csv")
    with pytest.raises(ValueError, match="tracker.csv: x goes .* it goes as y does: are its axes the base's"):
        refuse_other_axes(seen[:, [1, 0, 2]], joints, RATE, "tracker.csv")
    with pytest.raises(ValueError, match="its sign is reversed"):
        refuse_other_axes(seen * [-1.0, 1.0, 1.0], joints, RATE, "tracker.csv")


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (-1.0, "the force's sign appears reversed"),
        (3.0, "another unit of the force, or G_K of another robot"),
        (0.3, "another unit of the force, or G_K of another robot"),
        (0.0, "no force is measured"),
        (1e-3, "another unit of the force"),
    ],
)
def test_a_force_that_does_not_bend_the_tool_as_it_was_seen_is_refused(factor: float, words: str) -> None:
    bent = wandering(1e-4)
    foreseen = bent + wandering(1e-5, 7)
    refuse_other_compliance(bent, foreseen, RATE, "milled-0")
    with pytest.raises(ValueError, match=words):
        refuse_other_compliance(bent, factor * foreseen, RATE, "milled-0")


def test_a_cut_that_bends_nothing_tells_nothing() -> None:
    refuse_other_compliance(wandering(1e-6), wandering(1e-6, 4), RATE, "milled-0")


@pytest.mark.parametrize("seed", range(8))
def test_a_cut_that_bends_less_than_the_tracker_s_noise_is_not_refused_for_it(seed: int) -> None:
    """As a soft wood before a stiff arm: 1.3 µm in noise of 40 µm a sample, of which 8 µm are slow."""
    foreseen = wandering(1.3e-6, seed)
    refuse_other_compliance(foreseen + noise(seed), foreseen, RATE, "milled-0")
    refuse_other_compliance(5.0 * foreseen + noise(seed), 5.0 * foreseen, RATE, "milled-0")


@pytest.mark.parametrize("seed", range(4))
def test_in_the_same_noise_a_wrong_model_sign_or_clock_is_refused(seed: int) -> None:
    foreseen = wandering(3e-5, seed)
    bent = foreseen + noise(seed)
    refuse_other_compliance(bent, foreseen, RATE, "milled-0")
    for factor in (2.0, 0.5, -1.0):
        with pytest.raises(ValueError, match="times what G_K makes of the force"):
            refuse_other_compliance(bent, factor * foreseen, RATE, "milled-0")
    with pytest.raises(ValueError, match="have they one clock"):
        refuse_other_compliance(bent, np.roll(foreseen, 50, axis=0), RATE, "milled-0")


def noise(seed: int) -> np.ndarray:
    """Return the tracker's, 40 µm."""
    return np.asarray(4e-5 * np.random.default_rng(100 + seed).standard_normal((2_500, 3)))


def test_a_force_by_another_clock_is_refused() -> None:
    bent = wandering(1e-4)
    refuse_other_compliance(bent, np.roll(bent, 5, axis=0), RATE, "force.csv")
    with pytest.raises(ValueError, match=r"force.csv: the force is 0.1 s later .* have they one clock\?"):
        refuse_other_compliance(bent, np.roll(bent, 25, axis=0), RATE, "force.csv")


def test_without_a_tracker_a_sign_a_unit_and_nothing_at_all_are_told_by_g_m() -> None:
    foreseen = wandering(10.0)
    force = foreseen + wandering(6.0, 9)
    refuse_other_force(force, foreseen, RATE, "force.csv")
    refuse_other_force(2.0 * force, foreseen, RATE, "force.csv")
    for wrong, words in (
        (-force, "sign appears reversed"),
        (0.0 * force, "no force is measured"),
        (1e3 * force, "unit"),
    ):
        with pytest.raises(ValueError, match=words):
            refuse_other_force(wrong, foreseen, RATE, "force.csv")
