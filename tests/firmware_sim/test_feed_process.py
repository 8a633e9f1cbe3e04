"""The simulated process of fig. 7.5 against (7.4) to (7.10)."""

from typing import Any

import numpy as np
import pytest

from firmware_sim.plants.feed_process import FeedProcess

QUIET = {"kappa_swing": 0.0, "kappa_step": 0.0, "beta_swing": 0.0, "beta_step": 0.0, "force_noise": 0.0,
         "position_noise": 0.0}  # fmt: skip


def run(asked: np.ndarray, rate: float = 250.0, **options: Any) -> dict[str, np.ndarray]:
    plant = FeedProcess(rate, **(QUIET | options))
    names = ("velocity", "force", "true_force", "kappa", "beta")
    found = {name: np.zeros((len(asked), 2 if "force" in name else 1)) for name in names}
    plant.run(asked[:, None], *found.values())
    return found


def test_a_constant_feed_tends_to_the_force_of_7_10() -> None:
    force = run(np.full(500, 0.015))["force"][-1]
    assert np.hypot(*force) == pytest.approx(0.015 * np.hypot(1.0, 0.5) / 4e-4, rel=1e-6)
    assert force[1] == pytest.approx(0.5 * force[0])


def test_it_tends_there_with_the_time_constant_of_7_10() -> None:
    """1 / (K_f kappa) = 33 ms, with a robot that is much quicker."""
    force = run(np.full(500, 0.015), rate=1000.0, corner=200.0, mode=100.0, damping=1.0)["force"][:, 0]
    at = int(np.argmax(force > (1 - np.exp(-1.0)) * 37.5))
    assert at / 1000.0 == pytest.approx(1 / 30.0, abs=6e-3)


def test_a_tool_that_goes_back_is_not_pulled_and_finds_the_workpiece_where_it_left_it() -> None:
    asked = np.concatenate([np.full(250, 0.01), np.full(100, -0.01), np.full(90, 0.01), np.full(60, 0.01)])
    force = run(asked)["force"][:, 0]
    assert force.min() == 0.0
    assert (force[300:400] == 0.0).all()
    assert force[-1] > 5.0


def test_kappa_and_beta_swing_and_step_when_they_are_told_to() -> None:
    found = run(np.full(2500, 0.01), kappa_swing=1e-4, kappa_step=1e-4, kappa_at=6.0, beta_swing=0.1, beta_step=0.2)
    time = np.arange(2500) / 250.0
    wave = np.sin(2 * np.pi * 0.2 * time)
    np.testing.assert_allclose(found["kappa"][:, 0], 4e-4 + 1e-4 * wave + 1e-4 * (time >= 6.0), atol=1e-12)
    np.testing.assert_allclose(found["beta"][:, 0], 0.5 + 0.1 * wave + 0.2 * (time >= 9.0), atol=1e-9)


def test_the_force_is_the_same_at_any_rate() -> None:
    slow, quick = (run(np.full(round(rate), 0.01), rate=rate)["force"][-1, 0] for rate in (250.0, 1000.0))
    assert slow == pytest.approx(quick, rel=1e-3)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"stiffness": 1.0}, "stiffness is 1.0, must be 1000 to 1e"),
        ({"kappa_swing": 5e-4}, "must leave something of kappa"),
        ({"kappa_step": -4e-4}, "must leave something of kappa"),
    ],
)
def test_an_option_out_of_its_range_is_refused_by_name(options: dict[str, float], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        run(np.zeros(1), **options)


def test_another_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="rate is 10 samples/s, must be 50 to 10000"):
        FeedProcess(10)
