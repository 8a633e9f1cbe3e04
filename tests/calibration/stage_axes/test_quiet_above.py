"""How what lies above a model's band bounds the loop."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.stage_axes.above import HeardResponse
from calibration.stage_axes.allowed import ANSWER, quiet_above
from calibration.stage_axes.bench import left_alone
from calibration.stage_axes.calibration import inner_loop
from rigkit import config as rig_file
from stagectl.config import Outer, StageConfig
from stagectl.stage.allowed_gains import AllowedGains, frequencies_above
from stagectl.stage.design import NoLoop, design
from stagectl.stage.design_refinement import designed
from stagectl.stage.measured_response import SMALL
from tests.stagectl.experiments.piezo.linear_stage import model

AT_REST = abs(model("z").frequency_response(np.zeros(1))[0, 0, 0])


BAND = np.arange(200.0, 800.0)


def heard(gain: float, at: float | None = None) -> HeardResponse:
    """Return a gain re that at rest: of all frequencies, or of one alone."""
    return HeardResponse(BAND, AT_REST * gain * (np.ones_like(BAND) if at is None else np.where(at == BAND, 1.0, 1e-6)))


def allowed(above: HeardResponse, seen: HeardResponse | None) -> AllowedGains:
    return quiet_above(Outer(), 2, model("z"), above, seen)


FREQUENCY = frequencies_above(Outer(), model("z").rate)


@pytest.mark.parametrize("gain", [1e-3, 0.0])
def test_where_it_is_silent_or_noise_alone_is_heard_the_rig_files_bounds_hold(gain: float) -> None:
    found = allowed(heard(gain), heard(gain))
    np.testing.assert_allclose(found.feedback, Outer().beyond[0])
    np.testing.assert_allclose(found.forward, Outer().forward_beyond)


def test_one_that_rings_there_gets_a_loop_of_small_gain() -> None:
    found = allowed(heard(4.0), None)
    np.testing.assert_allclose(found.feedback, SMALL / 4.0)
    np.testing.assert_allclose(found.forward, ANSWER / 4.0)


def test_what_rings_at_one_frequency_bounds_the_gain_there_and_where_nobody_listened() -> None:
    found, frequency = allowed(heard(4.0, at=400.0), None), FREQUENCY
    near = np.abs(frequency / 400.0 - 1.0) < 0.05
    bound = found.feedback < 1.01 * SMALL / 4.0
    assert bound[near].all()
    assert bound[frequency > 1000.0].all()
    assert not bound[frequency < 300.0].any()
    assert not bound[(frequency > 500.0) & (frequency < 700.0)].any()


def test_what_a_laser_sees_otherwise_than_the_plates_sensor_bounds_the_answer_to_a_reference() -> None:
    np.testing.assert_allclose(allowed(heard(4.0), heard(0.2)).forward, SMALL / 0.2)


@pytest.mark.slow
def test_a_loop_leaves_out_what_rings_and_is_as_good_as_without_elsewhere() -> None:
    """A faint resonance far above costs less than the same bound for all frequencies."""
    outer = Outer(bandwidth=(100.0,))
    above = heard(2.0, at=700.0)
    one, all_of_them = (
        designed(model("z"), outer, 2, quiet_above(outer, 2, model("z"), each, above)) for each in (above, heard(2.0))
    )
    assert one.left < 0.95 * all_of_them.left
    assert one.beyond > 1.5 * all_of_them.beyond


def test_a_loop_that_is_made_anew_keeps_what_is_allowed_at_every_frequency() -> None:
    """Chosen weights alone have what was measured at each."""
    outer = Outer(allowed=(0.2,), bandwidth=(100.0,))
    assert design(model("z"), outer, 2).beyond <= 0.2
    chosen = design(model("z"), outer.model_copy(update={"allowed": ()}), 2)
    assert chosen.beyond > 0.21
    with pytest.raises(NoLoop, match=r"of those allowed"):
        design(model("z"), outer, 2, chosen.weights)
    again = design(model("z"), outer, 2, replace(chosen.weights, beyond=1.001 * chosen.beyond))
    assert again.beyond == pytest.approx(chosen.beyond)


def test_an_inner_loop_is_so_slow_that_its_gain_is_small_there() -> None:
    rig = rig_file.load(None, StageConfig, [])
    stack = model("z")
    _, as_wished, _ = inner_loop(rig, 2, stack)
    _, slowed, _ = inner_loop(rig, 2, stack, above=SMALL * AT_REST / 0.1)
    assert slowed.bandwidth[0] <= 0.1 < as_wished.bandwidth[0]


def test_nothing_is_milled_while_an_axis_is_excited() -> None:
    milled = rig_file.load(None, StageConfig, ["simulator.surroundings=firmware_sim.stage_blocks:Milling"])
    assert left_alone(milled).simulator.surroundings == StageConfig().simulator.surroundings
    assert left_alone(milled).simulator.plant == milled.simulator.plant
