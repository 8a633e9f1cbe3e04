"""The block of force control: its phases, its limits, and what it does when something goes wrong."""

from typing import Any

import numpy as np
import pytest

from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling.feed_force import PHASES, FeedForce
from stagectl.robot.milling.nominal_velocity import nominal_velocity

H = 0.004
MODEL = nominal_velocity(250.0)


class Bench:
    """The block against a workpiece of (7.4), which begins somewhere before the tool."""

    def __init__(self, ahead: float = 0.0, **settings: Any) -> None:
        self.block = FeedForce(ForceFeed(**settings), MODEL)
        self.block.prepare(250.0, 1)
        self.outputs = {port.name: np.zeros((1, port.width)) for port in self.block.outputs}
        self.kappa, self.beta, self.stiffness, self.gap = 4e-4, 0.5, 75e3, ahead
        self.place = self.removed = self.velocity = 0.0
        self._state = np.zeros(MODEL.order)
        self.force = np.zeros(2)

    def run(self, seconds: float, valid: float = 1.0, running: float = 1.0, force: float | None = None) -> np.ndarray:
        """Go on; return phase, feed wanted and resultant force, shape (samples, 3)."""
        told = []
        for _ in range(round(seconds / H)):
            seen = self.force if force is None else np.array([force, 0.0])
            self.block.process(np.array([[self.velocity]]), seen[None], np.array([[valid]]), np.array([[running]]),
                               *self.outputs.values())  # fmt: skip
            self._move(self.of("reference"))
            told.append([self.of("phase"), self.of("wanted"), self.of("resultant")])
        return np.array(told)

    def of(self, name: str) -> float:
        return float(self.outputs[name][0, 0])

    @property
    def phase(self) -> str:
        return PHASES[int(self.of("phase"))]

    def _move(self, asked: float) -> None:
        self.velocity = float((MODEL.C @ self._state)[0])
        self._state = MODEL.A @ self._state + MODEL.B[:, 0] * asked
        before = max(self.place - self.gap - self.removed, 0.0)
        self.place += H * self.velocity
        depth = max(self.place - self.gap - self.removed, 0.0)
        if before > 0.0 and depth > 0.0:  # f' = K_f (v - kappa f), exactly
            decay = self.kappa * self.stiffness * H
            depth = before - np.expm1(-decay) * (H * self.velocity / decay - before)
            self.removed = self.place - self.gap - depth
        along = self.stiffness * depth
        self.force = np.array([along, self.beta * along])


def test_it_is_idle_until_it_is_to_run_and_again_afterwards() -> None:
    bench = Bench()
    assert (bench.run(0.1, running=0.0) == 0.0).all()
    bench.run(0.5)
    assert bench.phase == "controlling"
    assert bench.run(0.1, running=0.0)[-1, 1] == 0.0
    assert bench.phase == "idle"


def test_it_approaches_touches_estimates_and_controls_in_this_order() -> None:
    told = Bench(ahead=1e-3).run(1.5)
    assert np.unique(told[:, 0]).tolist() == [1.0, 2.0, 3.0]
    assert (np.diff(told[:, 0]) >= 0).all()
    assert told[-1, 2] == pytest.approx(10.0, abs=0.02)


def test_the_first_feed_of_control_is_that_of_before() -> None:
    told = Bench(start="constant").run(1.0)
    at = int(np.argmax(told[:, 0] == 3.0))
    assert abs(told[at, 1] - told[at - 1, 1]) < 4e-3


def test_a_gentle_start_keeps_the_force_near_what_is_wanted_where_the_thesis_start_does_not() -> None:
    assert Bench(start="gentle").run(1.0)[:, 2].max() < 13.0
    assert Bench(start="constant").run(1.0)[:, 2].max() > 18.0


def test_the_estimates_come_to_what_is_true_and_their_deviations_shrink() -> None:
    bench = Bench(kappa=2e-3, beta=0.0)
    bench.run(1.0)
    assert bench.of("kappa") == pytest.approx(4e-4, rel=0.02)
    assert bench.of("beta") == pytest.approx(0.5, rel=0.01)
    assert bench.of("kappa_deviation") < 5e-5


def test_a_new_segment_is_estimated_anew() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.run(0.1, running=0.0)
    bench.run(0.004)
    assert bench.of("kappa_deviation") == pytest.approx(ForceFeed().kappa_deviation)


def test_nothing_is_learned_without_contact() -> None:
    bench = Bench(ahead=1.0)
    bench.run(1.0)
    assert bench.phase == "approaching"
    assert bench.of("kappa") == ForceFeed().kappa


def test_contact_that_is_lost_ends_control_until_it_is_back() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.gap += 2e-3
    told = bench.run(1.5)
    assert 1.0 in told[:, 0]
    assert told[:, 1].max() <= ForceFeed().highest
    assert bench.phase == "controlling"
    assert told[-1, 2] == pytest.approx(10.0, abs=0.05)


def test_the_feed_keeps_its_limits_and_does_not_wind_up() -> None:
    bench = Bench(highest=2e-3, initial=2e-3)
    told = bench.run(2.0)
    assert told[:, 1].max() <= 2e-3
    assert told[-1, 2] < 9.0
    bench.kappa = 1e-4  # now the force is reached
    after = bench.run(1.5)[:, 2]
    assert after.max() < 13.0
    assert after[-1] == pytest.approx(10.0, abs=0.1)


@pytest.mark.parametrize("stiffness", [50e3, 112.5e3])
def test_a_stiffness_that_is_wrong_by_a_third_leaves_no_error(stiffness: float) -> None:
    bench = Bench()
    bench.stiffness = stiffness
    told = bench.run(2.0)
    np.testing.assert_allclose(told[-100:, 2], 10.0, atol=0.05)


def test_overload_makes_it_retreat_and_stay_with_its_reason() -> None:
    bench = Bench()
    bench.run(1.0)
    place = bench.place
    bench.run(0.008, force=90.0)
    assert bench.phase == "retreating"
    bench.run(1.0)
    assert bench.phase == "retreated"
    assert bench.block.reason == "the force is beyond force.overload, 80 N"
    assert bench.of("reference") == pytest.approx(0.0, abs=1e-4)
    assert place - bench.place == pytest.approx(ForceFeed().distance, rel=0.25)


def test_a_spark_of_the_sensor_is_no_overload() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.run(0.004, force=500.0)
    bench.run(0.5)
    assert bench.phase == "controlling"


@pytest.mark.parametrize(("valid", "force"), [(0.0, None), (1.0, float("nan"))])
def test_no_valid_force_for_too_long_makes_it_retreat(valid: float, force: float | None) -> None:
    bench = Bench()
    bench.run(1.0)
    bench.run(0.016, valid=valid, force=force)
    assert bench.phase == "controlling"
    bench.run(0.008, valid=valid, force=force)
    assert bench.phase == "retreating"
    assert bench.block.reason == "there is no valid force for 0.02 s"
    assert np.isfinite(bench.run(1.0, valid=valid, force=force)).all()


def test_a_velocity_that_is_no_number_is_waited_for() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.velocity = float("nan")
    bench.run(0.004)
    assert np.isfinite(bench.of("reference"))
    bench.run(0.5)
    assert bench.of("resultant") == pytest.approx(10.0, abs=0.1)


def test_a_model_of_another_rate_is_refused() -> None:
    with pytest.raises(ValueError, match="250 samples/s, must be of 500"):
        FeedForce(ForceFeed(), MODEL).prepare(500.0, 1)
