"""Loop models and lambda tuning."""

import math

import numpy as np
import pytest

from stagectl.robot.midranging import loop_model_kernel as kernel
from stagectl.robot.midranging.tuning import LoopModel, Pi, integral, lambda_tuned


def test_a_loop_of_first_order_has_its_time_constant() -> None:
    assert LoopModel((0.96,), (0.04,)).time_constant(250.0) == pytest.approx(-0.004 / math.log(0.96), rel=1e-12)
    assert LoopModel.first_order(1.3, 250.0).time_constant(250.0) == pytest.approx(1.3, rel=1e-9)


def test_the_reduced_loop_has_the_area_above_the_step_response_of_the_whole_one() -> None:
    loop = LoopModel((1.5, -0.56), (0.02, 0.04))
    response, areas = [0.0, 0.0], []
    for each in (loop, LoopModel.first_order(loop.time_constant(250.0), 250.0).of_order(2)):
        response = [0.0, 0.0]
        for n in range(400):
            given = each.inputs[0] + each.inputs[1] * (n > 0)
            response.append(each.outputs[0] * response[-1] + each.outputs[1] * response[-2] + given)
        areas.append(float(np.sum(1.0 - np.array(response[2:]))))
    assert areas[0] == pytest.approx(areas[1], rel=1e-9)


def test_lambda_tuning_cancels_the_pole_and_sets_the_closed_loop() -> None:
    assert lambda_tuned(0.1, 0.1) == Pi(1.0, 10.0)
    assert lambda_tuned(0.2, 0.4) == Pi(0.5, 2.5)
    assert integral(4.0) == Pi(0.0, 0.25)
    with pytest.raises(ValueError, match=r"closed is nan s, must be finite and > 0"):
        lambda_tuned(1.0, math.nan)


def test_a_process_of_other_gain_in_the_same_loop() -> None:
    loop = LoopModel((0.96,), (0.04,)).with_process_gain(1.5)
    assert loop.inputs == pytest.approx((0.06,))
    assert loop.outputs == pytest.approx((0.94,))


@pytest.mark.parametrize(
    ("outputs", "inputs", "message"),
    [
        ((0.9,), (0.1, 0.0), "there are 1 a and 2 b, must be 1 to 3 of each"),
        ((1.0,), (0.1,), "poles must lie within"),
        ((0.9,), (0.5,), r"gain at rest within 0\.5 to 2\.0"),
        ((math.nan,), (0.5,), "poles must lie within"),
    ],
)
def test_what_is_no_position_loop_is_refused(
    outputs: tuple[float, ...], inputs: tuple[float, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        LoopModel(outputs, inputs)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_model_is_usable_exactly_where_its_poles_are_inside(order: int) -> None:
    random, seen = np.random.default_rng(order), set()
    for _ in range(400):
        outputs = random.uniform(-1.5, 1.5, order)
        gain = 1.0 - outputs.sum()
        parameters = np.concatenate((outputs, np.full(order, gain / order)))
        inside = bool((abs(np.roots([1.0, *-outputs])) < kernel.RADIUS).all() and gain > 0.0)
        assert kernel.is_usable(parameters, order) == inside
        seen.add(inside)
    assert seen == {True, False}
