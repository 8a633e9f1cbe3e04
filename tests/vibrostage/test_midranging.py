"""Mid-ranging on plain arrays: the programs' own controllers, against loops of its caller's."""

import math

import control
import numpy as np
import pytest
from scipy.signal import dlti, lti

from stagectl.experiments.midranging.scenario import STEPS, Scenario, steps
from stagectl.experiments.midranging.schedule import simulate as run_of_program
from stagectl.robot.midranging.controllers import controller
from stagectl.robot.midranging_config import MidrangeConfig
from vibrostage import midranging

RATE = 250.0
POLE = math.exp(-0.004)
FAST, SLOW = ([0.04], [1.0, -0.96]), ([1.0 - POLE], [1.0, -POLE])
INNER, LIMIT = (5.0,), 10e-3


def adaptive(scale: float = 1.0) -> midranging.Controller:
    return midranging.adaptive(
        FAST,
        SLOW,
        RATE,
        wave=0.5e-3 * scale,
        noise=1e-6 * scale,
        inner=INNER,
        limit=LIMIT * scale,
        travel=25e-3 * scale,
    )


def test_the_second_row_of_table_3_1_is_that_of_the_program() -> None:
    """Sörnmo 2015, table 3.1: 1.458 and 1.555; `stagectl midrange --scenario table-3.1` gives 1.441 and 1.548."""
    reference = steps(5e-3, RATE)
    laws = [midranging.valve_position(FAST, SLOW, RATE, kind, inner=INNER, limit=LIMIT) for kind in ("mvpc-aw", "mvpc")]
    errors = [midranging.simulate(law, FAST, SLOW, reference).iae for law in laws]
    own = midranging.simulate(adaptive(), FAST, SLOW, reference)
    assert own.iae / STEPS == pytest.approx(0.6348e-3, rel=1e-3)
    assert [each / own.iae for each in errors] == pytest.approx([1.441, 1.548], abs=2e-3)
    assert np.abs(own.control).max() <= LIMIT * (1.0 + 1e-9)


@pytest.mark.parametrize("kind", ["vpc", "mvpc", "mvpc-aw"])
def test_valve_position_control_is_the_programs_sample_by_sample(kind: str) -> None:
    config = MidrangeConfig()
    reference = steps(5e-3, RATE)[:3000]
    theirs = run_of_program(controller(kind, config), Scenario("steps", reference), config)
    ours = midranging.simulate(
        midranging.valve_position(FAST, SLOW, RATE, kind, inner=INNER, limit=LIMIT), FAST, SLOW, reference
    )
    asked = theirs.select(["fast_reference"]).data[:, 0]
    assert np.abs(asked - ours.fast_reference).max() < 0.02 * np.abs(asked).max()  # the pair is exact between samples


def test_python_control_simulates_the_same_loop() -> None:
    control = pytest.importorskip("control")
    poles, reference = (0.96, POLE), np.repeat([0.0, 1.0], [50, 2000])
    ours = midranging.simulate(midranging.valve_position(FAST, SLOW, RATE), FAST, SLOW, reference)
    z = control.tf([1, 0], [1], 1.0 / RATE)
    (fast_pi, slow_pi) = (1 - np.log(pole) / (z - 1) for pole in poles)
    fast, slow = ((1 - pole) / (z - pole) for pole in poles)
    peer = control.forced_response(control.feedback(fast_pi * (fast + slow * slow_pi)), ours.time, reference)
    assert np.abs(peer.outputs - ours.position).max() < 1e-6


def test_the_unit_of_length_does_not_matter() -> None:
    reference = steps(5e-3, RATE)[:3000]
    metres = midranging.simulate(adaptive(), FAST, SLOW, reference, noise=1e-6)
    micrometres = midranging.simulate(adaptive(1e6), FAST, SLOW, 1e6 * reference, noise=1.0)
    assert np.abs(micrometres.position - 1e6 * metres.position).max() < 1e-2


def test_a_state_space_is_taken_for_its_transfer_function_and_zeros_at_the_end_for_dead_time() -> None:
    a, b, c = np.diag([0.9, 0.7]), np.array([[1.0], [1.0]]), np.array([[0.05, 0.15]])
    model, delay = midranging.as_model((a, b, c))
    assert model.outputs == pytest.approx((1.6, -0.63))
    assert model.inputs == pytest.approx((0.2, -0.17))
    assert delay == 0
    assert midranging.as_model((SLOW[0], [*SLOW[1], *[0.0] * 7])) == (midranging.as_model(SLOW)[0], 7)


def test_loops_of_scipy_and_python_control_are_taken_as_they_are() -> None:
    late = SLOW[0], SLOW[1] + [0.0] * 12
    for kind in (lambda loop: dlti(*loop, dt=1 / RATE), lambda loop: control.tf(*loop, 1 / RATE)):
        assert midranging.as_model(kind(late)) == midranging.as_model(late)
    with pytest.raises(ValueError, match="fast: the system's sample period is dt = None"):
        midranging.valve_position(lti([1.0], [1.0, 1.0]), SLOW, RATE)


def test_a_dead_time_that_was_not_told_is_found_and_one_step_at_a_time_is_the_same() -> None:
    late = (SLOW[0], [*SLOW[1], *[0.0] * 12])
    law = adaptive()
    run = midranging.simulate(law, FAST, late, steps(2e-3, RATE)[:2500])
    assert law.is_active
    assert not law.has_taken_over
    assert law.models["slow"] == pytest.approx([POLE, 1.0 - POLE], rel=0.05)
    law.reset()
    assert not law.is_active
    first = law.step(0.0, 0.0)
    assert first == (0.5e-3, 0.5e-3)
    assert abs(run.position[-1] - run.reference[-1]) < 1e-4


@pytest.mark.parametrize(
    ("fast", "said"),
    [
        (([1.0], [1.0]), "fast: a loop has 1 coefficients over 1, must have fewer above"),
        (([0.1, 0.0, 0.0, 0.0], [1.0, -0.9, 0.0, 0.0, 0.1]), "fast: a loop is of order 4 beside its dead time"),
        (([0.2], [1.0, -1.7, 0.3]), "fast: the model has a"),
        ((np.eye(2), np.ones((2, 1)), np.ones((1, 3))), "fast: a loop has A"),
        ((np.eye(1), np.ones((1, 1)), np.ones((1, 1)), np.ones((1, 1))), "fast: a loop has D"),
        (([1.0],), "fast: a loop has 1 arrays"),
        (([math.nan], [1.0, -0.9]), "fast: a loop has a coefficient that is not finite"),
    ],
)
def test_what_is_no_loop_is_refused_by_name(fast: tuple[object, ...], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        midranging.valve_position(fast, SLOW, RATE)


def test_other_wrong_input_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="rate is 0"):
        midranging.valve_position(FAST, SLOW, 0.0)
    with pytest.raises(ValueError, match="kind is 'pid', must be one of vpc, mvpc, mvpc-aw"):
        midranging.valve_position(FAST, SLOW, RATE, "pid")
    with pytest.raises(ValueError, match="noise is 0.0 m"):
        midranging.adaptive(FAST, SLOW, RATE, wave=1.0, noise=0.0)
    with pytest.raises(ValueError, match="disturbance"):
        midranging.simulate(midranging.valve_position(FAST, SLOW, RATE), FAST, SLOW, np.zeros(5), np.zeros(4))


def test_a_dead_time_that_is_found_does_not_make_the_pair_slower_than_its_fast_loop() -> None:
    """The loop is told as of first order, 31 samples to 63 %; six of them turn out to be dead time."""
    pole, whole = math.exp(-1.0 / 25.0), math.exp(-1.0 / 31.0)
    told, itself = ([1.0 - whole], [1.0, -whole]), ([1.0 - pole], [1.0, -pole] + [0.0] * 6)
    law = midranging.adaptive(told, SLOW, RATE, wave=0.1, noise=1e-4, inner=(0.01,))
    run = midranging.simulate(law, itself, SLOW, np.repeat([0.0, 1.0], [100, 1500]))
    late = int(np.argmax(run.position >= 1.0 - math.exp(-1.0))) - 100
    assert 28 <= late <= 34
    assert run.position.max() < 1.1
