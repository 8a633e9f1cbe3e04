from pathlib import Path

import numpy as np
import pytest

from stagectl.robot.arm import ArmError, irb140, read_arm

ROW = "{offset_deg = 90, d = 0.5, a = 0.1, alpha_deg = -90, low_deg = -10, high_deg = 20, speed_deg = 180}"


def written(folder: Path, text: str) -> Path:
    file = folder / "arm.toml"
    file.write_text(text)
    return file


def test_the_robot_of_the_thesis_has_its_published_lengths_and_limits() -> None:
    arm = irb140()
    assert (arm.name, arm.joints) == ("ABB IRB 140", 6)
    np.testing.assert_array_equal(arm.d, [0.352, 0, 0, 0.380, 0, 0.065])
    np.testing.assert_array_equal(arm.a, [0.070, 0.360, 0, 0, 0, 0])
    np.testing.assert_allclose(np.degrees(arm.high - arm.low), [360, 200, 280, 400, 230, 800], rtol=1e-14)
    assert arm.reach == pytest.approx(np.hypot(0.352, 0.07) + 0.36 + 0.38 + 0.065)


def test_another_arm_is_read_from_a_file_in_degrees(tmp_path: Path) -> None:
    arm = read_arm(written(tmp_path, f'name = "one"\njoint = [{ROW}]\n'))
    assert arm.joints == 1
    np.testing.assert_allclose([arm.offset, arm.alpha, arm.speed], np.array([[0.5], [-0.5], [1.0]]) * np.pi)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("name = 'one'", "has name, must have name and a list of joint"),
        (f"name = 'one'\nextra = 1\njoint = [{ROW}]", "has name, extra, joint"),
        ("name = 'one'\njoint = [{d = 1}]", "joint 1 must have offset_deg, d, a"),
        (f"name = 'one'\njoint = [{ROW}, {ROW.replace('0.5', 'nan')}]", "joint.1.d is nan, must be finite"),
        (f"name = 'one'\njoint = [{ROW.replace('0.5', 'true')}]", "joint 1: d is True"),
        (f"name = 'one'\njoint = [{ROW.replace('= 20', '= -20')}]", "joint 1 goes from -10 to -20 deg"),
        (f"name = 'one'\njoint = [{ROW.replace('0.5', '1' + '0' * 400)}]", "joint 1: d is 10"),
        (f"name = 'one'\njoint = {'[' * 500}", "nested more than 12 deep"),
        ("name = ", "arm.toml"),
    ],
)
def test_a_file_that_is_no_arm_is_refused_by_file_joint_and_value(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(ArmError, match=says):
        read_arm(written(tmp_path, text))


def test_a_file_that_is_not_there_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(ArmError, match=r"nowhere\.toml"):
        read_arm(tmp_path / "nowhere.toml")


def test_angles_outside_the_limits_are_refused_by_joint_value_and_range() -> None:
    arm = irb140()
    arm.refuse_outside(np.zeros((3, 6)))
    with pytest.raises(ValueError, match=r"joint 2 is at 111 deg, must be -90 to 110"):
        arm.refuse_outside(np.radians([[0, 0, 0, 0, 0, 0], [0, 111, 0, 0, 0, 0]]))
    with pytest.raises(ValueError, match=r"joint 1 is at nan deg"):
        arm.refuse_outside(np.array([np.nan, 0, 0, 0, 0, 0]))
    with pytest.raises(ValueError, match=r"shape \(5,\), must be \(\.\.\., 6\)"):
        arm.refuse_outside(np.zeros(5))
