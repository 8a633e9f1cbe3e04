"""The stage in closed loop on a small linear plant: it starts, follows, holds, changes and stops without a step."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stagectl.config import Outer, StageConfig
from stagectl.stage.design import design
from stagectl.stage.hysteresis import HysteresisModel
from stagectl.stage.hysteresis_compensation import HysteresisCompensation
from stagectl.stage.loop import Stage, inner_loops, stage_controller
from stagectl.stage.state_feedback import StateFeedback
from tests.stagectl.experiments.piezo.linear_stage import INNER, LIMITS, Bench, LinearStage, model

CONFIG = StageConfig(inner=INNER, limits=LIMITS, outer=Outer(mistuning=0.0))
NOISE_STEP = 0.02
"""V between two samples that noise of the sensors alone explains."""


@cache
def loops() -> tuple[StateFeedback, ...]:
    return tuple(design(model(axis), CONFIG.outer, number).loop for number, axis in enumerate("xyz"))


def bench(config: StageConfig = CONFIG) -> Bench:
    made = Bench(config, stage_controller(config, loops()), LinearStage())
    made.run(0.4)
    made.reference.value[:] = made.graph.signal("plant.position")[0]
    return made


def running(config: StageConfig = CONFIG) -> Bench:
    made = bench(config)
    made.stage.start()
    made.run(0.3)
    return made


def largest_step(voltage: np.ndarray) -> float:
    return float(np.abs(np.diff(voltage, axis=0)).max())


def test_it_starts_without_a_step_wherever_the_reference_is() -> None:
    made = bench()
    made.reference.value[:] += 100e-6
    before = made.run(0.001)["voltage"]
    made.stage.start()
    after = made.run(0.3)
    assert largest_step(np.vstack([before[-1:], after["voltage"][:20]])) < NOISE_STEP
    np.testing.assert_allclose(after["position"][-500:].mean(axis=0), made.reference.value, atol=0.1e-6)


def test_it_follows_a_step_on_every_axis_without_remaining_error() -> None:
    made = running()
    made.reference.value += [20e-6, -10e-6, 5e-6]
    position = made.run(0.3)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), made.reference.value, atol=10e-9)


def test_a_push_on_the_plate_is_taken_back() -> None:
    made = running()
    made.push.value[:] = 5e-6
    position = made.run(0.3)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), made.reference.value, atol=10e-9)


def test_a_reference_beyond_the_travel_is_limited_and_what_winds_up_unwinds() -> None:
    made = running()
    made.reference.value[:] = 1.0
    position = made.run(0.5)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), CONFIG.limits.travel[1], atol=0.1e-6)
    assert min(made.stage.controller.met.reference) == 5_000
    made.reference.value[:] = 225e-6
    position = made.run(0.5)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), 225e-6, atol=0.1e-6)


def test_a_reference_that_is_no_number_is_held_off() -> None:
    made = running()
    made.reference.value[1] = np.nan
    position = made.run(0.1)["position"]
    assert np.isfinite(position).all()
    assert made.stage.controller.met.reference == (0, 1_000, 0)
    assert made.stage.fault is None


def test_hold_goes_to_mid_travel_and_follow_comes_back() -> None:
    made = running()
    made.reference.value += 30e-6
    made.run(0.3)
    made.stage.controller.hold()
    held = made.run(0.5)
    np.testing.assert_allclose(held["position"][-1_000:].mean(axis=0), 225e-6, atol=0.1e-6)
    assert largest_step(held["voltage"]) < 1.0
    made.stage.controller.follow()
    position = made.run(0.5)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), made.reference.value, atol=0.1e-6)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_gains_change_without_a_step_while_it_moves(axis: int) -> None:
    made = running()
    made.reference.value += 40e-6
    before = made.run(0.004)
    outer = replace(
        loops()[axis], feedback=0.7 * loops()[axis].feedback, servo_feedback=0.5 * loops()[axis].servo_feedback
    )
    inner = replace(inner_loops(CONFIG)[axis], proportional=0.0)
    made.graph.changes.append(lambda: made.stage.controller.change_outer(axis, outer))
    made.graph.changes.append(lambda: made.stage.controller.change_inner(axis, inner))
    after = made.run(0.3)
    for signal, noise in (("voltage", NOISE_STEP), ("extension_reference", 5e-9)):
        usual = largest_step(before[signal][-20:, axis])
        assert abs(after[signal][0, axis] - before[signal][-1, axis]) < usual + noise, signal
    np.testing.assert_allclose(after["position"][-1_000:].mean(axis=0), made.reference.value, atol=0.1e-6)


def test_another_model_takes_over_without_a_step() -> None:
    made = running()
    other = design(model("z"), CONFIG.outer.model_copy(update={"bandwidth": (30.0,)}), 2).loop
    before = made.run(0.004)["voltage"]
    made.graph.changes.append(lambda: made.stage.controller.change_outer(2, other))
    after = made.run(0.3)
    assert np.abs(after["voltage"][0] - before[-1]).max() < NOISE_STEP
    np.testing.assert_allclose(after["position"][-1_000:].mean(axis=0), made.reference.value, atol=0.1e-6)


@pytest.mark.parametrize("sensor", ["position", "extension"])
def test_a_broken_sensor_takes_the_stage_to_rest_and_a_person_starts_it_again(sensor: str) -> None:
    made = running()
    made.plant.broken[sensor, 1] = np.nan
    broken = made.run(0.3)
    assert largest_step(broken["voltage"]) < 0.5
    np.testing.assert_array_equal(broken["voltage"][-1], CONFIG.limits.rest_voltage)
    with pytest.raises(ValueError, match="latched"):
        made.stage.start()
    made.plant.broken.clear()
    made.run(0.1)
    assert f"{sensor} 2 is not a number" in made.stage.clear("anna")
    made.stage.start()
    position = made.run(0.4)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), made.reference.value, atol=0.1e-6)
    assert made.stage.fault is None


def test_stop_takes_the_voltages_to_rest_and_it_starts_again() -> None:
    made = running()
    made.reference.value += 50e-6
    made.run(0.3)
    made.stage.stop()
    stopped = made.run(0.3)["voltage"]
    assert largest_step(stopped) < 0.5
    np.testing.assert_array_equal(stopped[-1], 50.0)
    made.stage.start()
    made.run(0.3)
    assert made.stage.guard.is_open


def test_with_hysteresis_undone_in_series_it_still_starts_without_a_step_and_follows() -> None:
    """On a linear plant the compensation itself is the disturbance: wrong by some volts wherever it stands."""
    model = HysteresisModel(
        0.0,
        100.0,
        np.array([45e-6, 35e-6, 0.0, 0.0]),
        np.zeros(2),
        np.zeros(2),
        np.array([0.1, 0.3]),
        np.array([6e-6, 4e-6]),
        10_000.0,
        0.0,
        0,
    )
    made = Bench(CONFIG, stage_controller(CONFIG, loops()), LinearStage(), HysteresisCompensation([model, None, model]))
    made.run(0.4)
    made.reference.value[:] = made.graph.signal("plant.position")[0]
    before = made.run(0.001)["voltage"]
    made.stage.start()
    after = made.run(0.5)
    assert largest_step(np.vstack([before[-1:], after["voltage"][:200]])) < 0.1
    assert np.abs(made.graph.signal("guard.voltage") - made.graph.signal("controller.request"))[0, 0] > 0.5
    np.testing.assert_allclose(after["position"][-1_000:].mean(axis=0), made.reference.value, atol=0.1e-6)
    made.reference.value += 30e-6
    position = made.run(0.4)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), made.reference.value, atol=0.1e-6)


def test_it_does_not_start_before_it_is_at_rest() -> None:
    made = Bench(CONFIG, stage_controller(CONFIG, loops()), LinearStage())
    made.run(0.01)
    with pytest.raises(ValueError, match="on its way to rest"):
        made.stage.start()


def test_one_axis_can_be_controlled_alone() -> None:
    config = CONFIG.model_copy(update={"stage": CONFIG.stage.model_copy(update={"axes": ("y",)})})
    made = Bench(config, stage_controller(config, loops()[1:2]), LinearStage(("y",)))
    made.run(0.4)
    made.reference.value[:] = 240e-6
    made.stage.start()
    position = made.run(0.4)["position"]
    np.testing.assert_allclose(position[-1_000:].mean(axis=0), 240e-6, atol=0.1e-6)
    assert isinstance(made.stage, Stage)


def test_a_controller_designed_for_another_rate_is_refused() -> None:
    other = replace(loops()[0], model=replace(loops()[0].model, rate=5_000.0))
    controller = stage_controller(CONFIG, (other, *loops()[1:]))
    with pytest.raises(ValueError, match="axis 1: the model has 5000 samples/s, must be 10000"):
        controller.prepare(10_000.0, 1)
