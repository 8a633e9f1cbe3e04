"""The whole way from angles and torques to forces: as a record, as a Block, as a file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigkit.model_file import ModelFile, ModelFileError, write_model_file
from stagectl.robot.kinematics import jacobian
from stagectl.robot.learning_config import ForceEstimation, Margin
from stagectl.robot.milling.force_estimate import estimate_force
from stagectl.robot.milling.force_model import ForceEstimate
from stagectl.robot.milling.friction_range import FrictionRange
from stagectl.robot.milling.torque_file import FORMAT, UNITS, read_force_model, torque_arrays
from tests.stagectl.robot.milling.force_cases import NOISE
from tests.stagectl.robot.milling.torque_models import ARM, INERTIA, wide_friction, wide_model

RATE = 250.0
MODEL = wide_model()
PATH = 0.3 + 0.1 * np.sin(np.arange(300)[:, None] / 40 + np.arange(6))
TORQUE = MODEL.gravity.torque(ARM, PATH) + np.random.default_rng(1).normal(size=(300, 6))


def slack_by_hand(acceleration: np.ndarray) -> np.ndarray:
    """Return three standard deviations, 0.3 N m, and four times inertia by the largest acceleration, which fades."""
    lately = np.abs(acceleration)
    for n in range(1, len(lately)):
        lately[n] = np.maximum(lately[n], np.exp(-1 / (0.1 * RATE)) * lately[n - 1])
    return np.asarray(3 * NOISE + 0.3 + 4 * INERTIA * lately)


def test_a_record_is_gravity_friction_and_jacobian_put_together() -> None:
    found = MODEL.estimate(PATH, TORQUE, RATE)
    friction = MODEL.friction.at(MODEL.friction.speeds(PATH, RATE))
    bare = TORQUE - MODEL.gravity.torque(ARM, PATH)
    slack = slack_by_hand(np.diff(MODEL.friction.speeds(PATH, RATE), axis=0, prepend=0.0) * RATE)
    expected = estimate_force(bare, jacobian(ARM, PATH), friction, MODEL.friction.covariance, slack=slack)
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
    arrays = torque_arrays(MODEL.friction, MODEL.gravity, INERTIA)
    settings = ForceEstimation(tie_break="minimum-norm", margin=Margin(moment=0.5))
    write_model_file(tmp_path / "milling.h5", ModelFile(FORMAT, arrays, UNITS))
    found = read_force_model(tmp_path / "milling.h5", ARM, settings)
    assert found.tie_break == "minimum-norm"
    likely, expected = (replace(each, margin=settings.margin, tie_break="centre") for each in (found, MODEL))
    assert (likely.estimate(PATH, TORQUE, RATE).low == expected.estimate(PATH, TORQUE, RATE).low).all()
    write_model_file(tmp_path / "bad.h5", ModelFile(FORMAT, arrays | {"friction/high": arrays["friction/low"]}, UNITS))
    with pytest.raises(ModelFileError, match=r"bad.h5: friction of joint 1 .* must rise"):
        read_force_model(tmp_path / "bad.h5", ARM, settings)
    write_model_file(tmp_path / "none.h5", ModelFile(FORMAT, {}, {}))
    with pytest.raises(ModelFileError, match=r"none.h5: not a readable model file"):
        read_force_model(tmp_path / "none.h5", ARM, settings)


def test_a_file_from_before_inertia_was_found_is_refused_with_what_to_do(tmp_path: Path) -> None:
    arrays = torque_arrays(MODEL.friction, MODEL.gravity, INERTIA)
    del arrays["inertia/joints"]
    write_model_file(tmp_path / "old.h5", ModelFile(FORMAT, arrays, UNITS))
    with pytest.raises(ModelFileError, match=r"old.h5: has no inertia/joints, .* `calibrate milling` fit it again"):
        read_force_model(tmp_path / "old.h5", ARM, ForceEstimation())
    write_model_file(tmp_path / "bad.h5", ModelFile(FORMAT, arrays | {"inertia/joints": -INERTIA}, UNITS))
    with pytest.raises(ModelFileError, match=r"bad.h5: inertia is \[-6.*must be 6 numbers >= 0 kg m\^2"):
        read_force_model(tmp_path / "bad.h5", ARM, ForceEstimation())


def test_without_a_margin_bounds_are_those_of_the_forces_that_are_as_likely() -> None:
    none = replace(MODEL, margin=Margin(noise=0.0, moment=0.0, inertia=0.0))
    likely, found = none.estimate(PATH, TORQUE, RATE), MODEL.estimate(PATH, TORQUE, RATE)
    friction = MODEL.friction.at(MODEL.friction.speeds(PATH, RATE))
    bare = TORQUE - MODEL.gravity.torque(ARM, PATH)
    expected = estimate_force(bare, jacobian(ARM, PATH), friction, MODEL.friction.covariance)
    assert likely.low == pytest.approx(expected.low, abs=1e-9)
    assert (found.force == likely.force).all()
    assert (found.objective == likely.objective).all()
    assert (found.low < likely.low).all()
    assert (found.high > likely.high).all()


def test_an_arm_that_was_shaken_has_wide_bounds_until_it_has_come_to_rest() -> None:
    """At rest for 1 s but for one jerk of joint 2 by 1 mrad within 40 ms; the torques show none of it."""
    angle = np.tile(PATH[0], (250, 1))
    angle[50:, 1] += 1e-3 * np.clip(np.arange(200) / 10, 0, 1)
    found = MODEL.estimate(angle, MODEL.gravity.torque(ARM, angle), RATE)
    width = (found.high - found.low)[:, 2]
    assert width[55] > 1.5 * width[40]
    assert (np.diff(width[70:]) <= 1e-6).all()
    assert width[-1] == pytest.approx(width[40], rel=0.01)


def test_a_gap_is_no_acceleration() -> None:
    angle = np.tile(PATH[0], (60, 1)) + 0.05 * np.arange(60)[:, None] / RATE
    angle[30:33] = np.nan
    found = MODEL.estimate(angle, MODEL.gravity.torque(ARM, np.nan_to_num(angle, nan=0.3)), RATE)
    width = (found.high - found.low)[:, 2]
    assert width[33] < width[29]
