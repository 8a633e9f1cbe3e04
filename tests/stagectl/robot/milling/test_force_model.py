"""The whole way from angles and torques to forces: as a record, as a Block, as a file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFile, ModelFileError, write_model_file
from stagectl.robot.kinematics import jacobian
from stagectl.robot.milling.force_estimate import estimate_force
from stagectl.robot.milling.force_model import ForceEstimate
from stagectl.robot.milling.friction_range import FrictionRange
from stagectl.robot.milling.torque_file import FORMAT, UNITS, read_force_model, torque_arrays
from tests.stagectl.robot.milling.torque_models import ARM, wide_friction, wide_model

RATE = 250.0
MODEL = wide_model()
PATH = 0.3 + 0.1 * np.sin(np.arange(300)[:, None] / 40 + np.arange(6))
TORQUE = MODEL.gravity.torque(ARM, PATH) + np.random.default_rng(1).normal(size=(300, 6))


def test_a_record_is_gravity_friction_and_jacobian_put_together() -> None:
    found = MODEL.estimate(PATH, TORQUE, RATE)
    friction = MODEL.friction.at(MODEL.friction.speeds(PATH, RATE))
    bare = TORQUE - MODEL.gravity.torque(ARM, PATH)
    expected = estimate_force(bare, jacobian(ARM, PATH), friction, MODEL.friction.covariance)
    assert found.force == pytest.approx(expected.force, abs=1e-9)
    assert found.low == pytest.approx(expected.low, abs=1e-9)
    assert found.high == pytest.approx(expected.high, abs=1e-9)


def test_the_block_gives_the_record_bit_for_bit() -> None:
    found, block = MODEL.estimate(PATH, TORQUE, RATE), ForceEstimate(MODEL)
    block.prepare(RATE, 1)
    for n in range(len(PATH)):
        told = [np.zeros((1, port.width)) for port in block.outputs]
        block.process(PATH[n : n + 1], TORQUE[n : n + 1], *told)
        assert (told[0][0] == found.force[n]).all()
        assert (told[1][0] == found.low[n]).all()
        assert (told[2][0] == found.high[n]).all()
        assert bool(told[3][0, 0]) == found.unique[n]


def test_a_gap_tells_nothing_and_what_comes_after_it_does() -> None:
    angle = PATH.copy()
    angle[100:110, 2] = np.nan
    found = MODEL.estimate(angle, TORQUE, RATE)
    gap = np.isnan(found.force).all(axis=1)
    assert list(np.flatnonzero(gap)) == list(range(100, 110))
    assert (found.low[gap] == -np.inf).all()


def test_a_joint_faster_than_friction_is_known_tells_nothing() -> None:
    slow = replace(MODEL, friction=wide_friction(0.05, smoothing=0.0))
    angle = PATH[0] + np.arange(20)[:, None] * np.array([0.0, 0.04, 0.0, 0.0, 0.0, 0.0]) / RATE
    angle[10:] += 0.02 * np.arange(1, 11)[:, None] / RATE
    found = slow.estimate(angle, TORQUE[:20], RATE)
    assert np.isfinite(found.force[:10]).all()
    assert np.isnan(found.force[10:]).all()


def test_speeds_are_those_of_a_ramp_behind_the_low_pass() -> None:
    friction = wide_friction(smoothing=0.02)
    ramp = 0.3 * np.arange(200)[:, None] / RATE * np.ones(6)
    found = friction.speeds(ramp, RATE)
    assert found[0] == pytest.approx(np.zeros(6))
    assert found[-1] == pytest.approx(np.full(6, 0.3))
    assert found[5, 0] == pytest.approx(0.3 * (1 - np.exp(-5 / (0.02 * RATE))))  # five differences so far


def test_between_knots_a_range_is_straight() -> None:
    made = wide_friction(1.0)
    speed = made.speed.copy()
    low, high = made.low.copy(), made.high.copy()
    high[3, 1], high[4, 1] = 10.0, 20.0
    found = FrictionRange(speed, low, high, made.covariance, 0.0).at(np.array([[0.0, 0.75, 0, 0, 0, 0], [2.0] * 6]))
    assert found[0, 1, 1] == pytest.approx(15.0)
    assert found[0, 0] == pytest.approx(low[2])
    assert np.isnan(found[1]).all()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"low": wide_friction().high}, "friction of joint 1 at -100 rad/s: 8 to 8 N m, must rise"),
        ({"speed": wide_friction().speed[::-1]}, "speed has 5 knots, must have 2 at least, which rise"),
        ({"speed": wide_friction().speed + 101}, "must reach both ways"),
        ({"covariance": np.zeros((6, 6))}, "covariance must be positive definite"),
        ({"smoothing": -1.0}, "smoothing is -1.0 s, must be >= 0 and finite"),
        ({"high": np.ones((4, 6))}, r"high has shape \(4, 6\), must be \(5, 6\) and finite"),
    ],
)
def test_ranges_that_cannot_be_are_refused(change: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        replace(wide_friction(), **change)  # type: ignore[arg-type]


def test_the_file_gives_the_model_back(tmp_path: Path) -> None:
    arrays = torque_arrays(MODEL.friction, MODEL.gravity)
    write_model_file(tmp_path / "milling.h5", ModelFile(FORMAT, arrays, UNITS))
    found = read_force_model(tmp_path / "milling.h5", ARM, "minimum-norm")
    assert found.tie_break == "minimum-norm"
    assert (found.estimate(PATH, TORQUE, RATE).low == MODEL.estimate(PATH, TORQUE, RATE).low).all()
    write_model_file(tmp_path / "bad.h5", ModelFile(FORMAT, arrays | {"friction/high": arrays["friction/low"]}, UNITS))
    with pytest.raises(ModelFileError, match=r"bad.h5: friction of joint 1 .* must rise"):
        read_force_model(tmp_path / "bad.h5", ARM)
    write_model_file(tmp_path / "none.h5", ModelFile(FORMAT, {}, {}))
    with pytest.raises(ModelFileError, match=r"none.h5: not a readable model file"):
        read_force_model(tmp_path / "none.h5", ARM)
