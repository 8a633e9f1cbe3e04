"""Adaptive internal model control around pairs of loops of order one to three."""

import numpy as np
import pytest

from stagectl.robot.midranging.estimation import Estimation
from stagectl.robot.midranging.internal_model import InternalModel, InternalModelAxis
from stagectl.robot.midranging.least_squares import LeastSquares
from stagectl.robot.midranging.reference_governor import Governor
from stagectl.robot.midranging.tuning import LoopModel

RATE = 250.0
FAST = {
    1: LoopModel((0.96,), (0.04,)),
    2: LoopModel((1.6, -0.63), (0.02, 0.01)),
    3: LoopModel((1.6, -0.7, 0.06), (0.035, 0.01, -0.005)),
}
SLOW = LoopModel.first_order(1.0, RATE)
TURNED = LoopModel((1.6, -0.63), (-0.03, 0.06))
"""Its zero is at 2."""


def _axis(fast: LoopModel, guess: LoopModel | None = None, **more: object) -> InternalModelAxis:
    wanted = LoopModel.first_order(fast.time_constant(RATE), RATE)
    settings: dict[str, object] = {"governor": Governor((1.0,)), "estimation": Estimation(0.0)}
    return InternalModelAxis(guess or fast, SLOW, wanted, SLOW, **{**settings, **more})  # type: ignore[arg-type]


def _run(
    axis: InternalModelAxis,
    fast: LoopModel,
    reference: np.ndarray,
    disturbance: float = 0.0,
    dark: tuple[str, ...] = (),
) -> dict[str, np.ndarray]:
    """Run one axis against a pair that is exactly what `fast` and `SLOW` say, from the middle of its travel."""
    block, past_w, past_y = InternalModel([axis]), np.zeros(4), np.zeros(4)
    block.prepare(RATE, 1)
    slow, given = 0.0, 0.0
    outputs = {port.name: np.zeros((1, port.width)) for port in block.outputs}
    kept: dict[str, list[float]] = {name: [] for name in ("relative", "fast", "slow", *outputs)}
    for n, value in enumerate(reference):
        position = past_y[: fast.order] @ fast.outputs + past_w[: fast.order] @ fast.inputs
        slow = SLOW.outputs[0] * slow + SLOW.inputs[0] * given
        relative = position + slow + disturbance * (n >= len(reference) // 2)
        shown = {"reference": value, "relative": relative, "fast": position + axis.middle, "slow": slow}
        shown |= dict.fromkeys(dark, np.nan) if 400 <= n < 700 else {}
        seen = [np.array([[each]]) for each in shown.values()]
        block.process(*seen, *outputs.values())
        wanted, given = outputs["fast_reference"][0, 0] - axis.middle, outputs["slow_reference"][0, 0]
        past_w, past_y = np.array([wanted, *past_w[:-1]]), np.array([position, *past_y[:-1]])
        for name, number in (("relative", relative), ("fast", position), ("slow", slow)):
            kept[name].append(number)
        for name, signal in outputs.items():
            kept[name].append(signal[0].copy())
    return {name: np.array(values) for name, values in kept.items()} | {"blind": np.array(block.blind)}


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_response_is_the_desired_one_and_the_fast_manipulator_returns(order: int) -> None:
    axis = _axis(FAST[order], middle=0.25e-3)
    got = _run(axis, FAST[order], np.full(2500, 1e-3))
    pole = axis.desired_fast.outputs[0]
    np.testing.assert_allclose(got["relative"], 1e-3 * (1.0 - pole ** np.arange(2500)), atol=2e-9)
    assert abs(got["fast"][-1]) < 1e-6
    assert got["slow"][-1] == pytest.approx(1e-3, rel=1e-3)
    assert got["fast_reference"][-1, 0] == pytest.approx(0.25e-3, abs=1e-6)


def test_a_disturbance_goes_as_a_step_of_the_reference_would() -> None:
    axis = _axis(FAST[1])
    got = _run(axis, FAST[1], np.zeros(4000), disturbance=1e-3)
    np.testing.assert_allclose(got["relative"][2000:], 1e-3 * 0.96 ** np.arange(2000), atol=1e-9)


def test_a_zero_outside_the_unit_circle_is_not_inverted() -> None:
    got = _run(_axis(TURNED), TURNED, np.full(2500, 1e-3))
    assert abs(got["fast_reference"]).max() < 0.1
    assert got["relative"][-1] == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_estimation_phase_finds_loops_that_were_guessed_wrong(order: int) -> None:
    guess = LoopModel.first_order(0.2, RATE).of_order(order)
    learning = LeastSquares(noise=1e-9)
    axis = _axis(FAST[order], guess, fast_learning=learning, estimation=Estimation(2.0, 0.01))
    got = _run(axis, FAST[order], np.concatenate((np.zeros(3000), np.full(1000, 1e-3))))
    begins = int(np.flatnonzero(got["active"][:, 0])[0])
    assert 500 <= begins < 2000
    assert abs(got["fast_reference"][:begins]).max() == pytest.approx(0.5e-3)
    np.testing.assert_allclose(got["fast_model"][-1], FAST[order].parameters, atol=1e-3)
    pole = axis.desired_fast.outputs[0]
    np.testing.assert_allclose(got["relative"][3000:], 1e-3 * (1.0 - pole ** np.arange(1000)), atol=2e-5)


def test_valve_position_control_takes_over_from_an_inaccurate_model() -> None:
    deaf = LeastSquares(deviation=1e-9)
    phase = Estimation(1.0, 0.01, acceptable=0.01, half_periods=4.0)
    axis = _axis(FAST[1], LoopModel((0.9,), (0.1,)), fast_learning=deaf, estimation=phase)
    got = _run(axis, FAST[1], np.concatenate((np.zeros(1500), np.full(2500, 1e-3))))
    assert not got["active"][:1000].any()
    assert (got["active"][1000:] == 2.0).all()
    assert got["relative"][-1] == pytest.approx(1e-3, rel=0.02)


def test_an_estimate_that_is_no_position_loop_is_not_used() -> None:
    """The sensor shows the wrong sign: the estimate follows, the model in use does not."""
    block, wrong = InternalModel([_axis(FAST[1])]), np.zeros((500, 1))
    block.prepare(RATE, 500)
    outputs = [np.zeros((500, port.width)) for port in block.outputs]
    wrong[:, 0] = -1e-3 * (1.0 - 0.96 ** np.arange(500))
    block.process(np.full((500, 1), 1e-3), wrong, wrong, 0 * wrong, *outputs)
    models = outputs[5]
    assert (models[:, 1] > 0.0).all()
    assert (abs(models[:, 0]) < 1.0).all()
    assert np.isfinite(np.hstack(outputs)).all()


@pytest.mark.parametrize("blinded", ["relative", "fast", "slow"])
def test_while_a_sensor_is_blind_the_models_fly_on(blinded: str) -> None:
    """With exact models and no disturbance nothing is lost; afterwards the sensor is heard again."""
    reference = np.where(np.arange(1500) // 250 % 2, -1e-3, 1e-3)
    seeing, blind = (_run(_axis(FAST[2]), FAST[2], reference, dark=dark) for dark in ((), (blinded,)))
    assert blind["blind"] == 300
    np.testing.assert_allclose(blind["relative"], seeing["relative"], atol=1e-9)


def test_axes_do_not_touch_each_other() -> None:
    axes = [
        _axis(FAST[2], estimation=Estimation(0.2, 100.0)),
        _axis(FAST[2], middle=1e-3, governor=Governor((1.0,), limit=1e-3)),
    ]
    signals = list(np.random.default_rng(5).uniform(-1e-4, 1e-4, (4, 300, 2)))

    def run(chosen: list[InternalModelAxis], columns: list[int]) -> list[np.ndarray]:
        block = InternalModel(chosen)
        block.prepare(RATE, 300)
        outputs = [np.zeros((300, port.width)) for port in block.outputs]
        block.process(*(np.ascontiguousarray(signal[:, columns]) for signal in signals), *outputs)
        return outputs

    both = run(axes, [0, 1])
    for number, axis in enumerate(axes):
        for one, other in zip(both, run([axis], [number]), strict=True):
            width = other.shape[1]
            np.testing.assert_array_equal(one[:, number * width : (number + 1) * width], other)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"desired_slow": LoopModel((0.9,), (0.09,))}, r"desired_slow has the gain 0\.9 at rest, must be 1"),
        ({"middle": float("nan")}, "middle is nan m, must be finite"),
        ({"governor": Governor((5.0,), limit=1e-3)}, r"fast_amplitude is 0\.0005 m, must be at most 0\.0001 m"),
        ({"governor": Governor((5.0,), travel=0.5e-3)}, r"must be at most half of the 0\.0005 m to the end"),
    ],
)
def test_what_does_not_fit_together_is_refused(wrong: dict[str, object], message: str) -> None:
    settings = {
        "fast": FAST[1],
        "slow": SLOW,
        "desired_fast": FAST[1],
        "desired_slow": SLOW,
        "governor": Governor((5.0,)),
    }
    with pytest.raises(ValueError, match=message):
        InternalModelAxis(**{**settings, **wrong})  # type: ignore[arg-type]


def test_axes_of_two_orders_are_refused() -> None:
    with pytest.raises(ValueError, match=r"models of the orders \[1, 2\], must have one"):
        InternalModel([_axis(FAST[1]), _axis(FAST[2])])


def test_a_wrong_estimation_phase_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"slow_half_period is 0\.0 s, must be finite and > 0"):
        Estimation(slow_half_period=0.0)
