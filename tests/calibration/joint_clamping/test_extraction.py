import numpy as np
import pytest

from calibration.joint_clamping.extraction import extract
from calibration.joint_clamping.torque_map import TorqueMap, TorqueMapError
from tests.calibration.joint_clamping.clamped_arm import RATE, ClampedArm, Joints, random_joints, to_and_fro


def recorded(parts: Joints, joint: int, **surroundings: float) -> TorqueMap:
    arm = ClampedArm(parts, **surroundings)  # type: ignore[arg-type]
    angle, torque, _ = arm.run(to_and_fro(arm, joint))
    return TorqueMap(angle[:, joint], torque[:, joint], RATE)


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(20))
def test_in_a_stiff_clamp_stiffness_is_found_within_2_percent_and_backlash_within_5_percent(seed: int) -> None:
    parts, joint = random_joints(seed), seed % 6
    found = extract(recorded(parts, joint, seed=seed))
    assert found.k_plus.value == pytest.approx(parts.k_plus[joint], rel=0.02)
    assert found.k_minus.value == pytest.approx(parts.k_minus[joint], rel=0.02)
    assert found.has_backlash
    assert found.backlash.value == pytest.approx(parts.backlash[joint], rel=0.05)
    assert found.friction.value == pytest.approx(parts.friction[joint], rel=0.05)
    assert found.spring == "piecewise linear"
    assert found.k_plus.low < parts.k_plus[joint] < found.k_plus.high


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(6))
def test_where_there_is_no_backlash_it_is_called_not_significant_with_its_bound(seed: int) -> None:
    parts, joint = random_joints(seed, backlash=False), seed % 6
    found = extract(recorded(parts, joint, seed=seed))
    assert not found.has_backlash
    assert found.backlash_said.startswith("not significant (< 0.00")
    assert found.backlash_bound < 0.02e-3
    assert found.k_plus.value == pytest.approx(parts.k_plus[joint], rel=0.005)
    assert found.k_minus.value == pytest.approx(parts.k_minus[joint], rel=0.005)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_spring_that_hardens_is_found_to_be_smooth_and_its_cubics_measured(seed: int) -> None:
    parts, joint = random_joints(seed, hardening=0.15), seed % 6
    found = extract(recorded(parts, joint, seed=seed))
    assert found.spring == "smooth"
    assert found.k_plus.value == pytest.approx(parts.k_plus[joint], rel=0.02)
    assert found.cubic_plus.value == pytest.approx(0.15e6 * parts.k_plus[joint], rel=0.1)
    assert found.backlash.value == pytest.approx(parts.backlash[joint], rel=0.05)


def test_wrong_samples_and_strong_drift_do_little_harm() -> None:
    parts = random_joints(2)
    found = extract(recorded(parts, 2, outliers=0.01, drift=0.05))
    assert found.k_plus.value == pytest.approx(parts.k_plus[2], rel=0.01)
    assert found.backlash.value == pytest.approx(parts.backlash[2], rel=0.05)


@pytest.mark.slow
def test_the_intervals_hold_the_truth_as_often_as_they_say() -> None:
    """95 %; of 24 figures at least 20."""
    held = []
    for seed in range(8):
        parts = random_joints(seed)
        found = extract(recorded(parts, 3, seed=seed, noise=0.01), "piecewise linear")
        for truth, said in (
            (parts.k_plus[3], found.k_plus),
            (parts.k_minus[3], found.k_minus),
            (parts.backlash[3], found.backlash),
        ):
            held.append(said.low < truth < said.high)
            assert said.error < (0.05 if said is found.backlash else 0.005) * truth
    assert sum(held) >= 20


def test_an_arm_that_is_not_clamped_has_no_map() -> None:
    time = np.linspace(0, 10, 5000)
    angle = np.sin(2 * np.pi * time / 2)
    with pytest.raises(TorqueMapError, match="is the arm clamped"):
        extract(TorqueMap(angle, -angle, 500.0))
