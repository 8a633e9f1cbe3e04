import numpy as np
import pytest

from stagectl.robot.arm import irb140
from stagectl.robot.kinematics import forward, frames, jacobian, turns

ARM = irb140()


def angles(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(ARM.low, ARM.high, (count, 6))


def moved(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the six-vector between two poses that are close together."""
    turn = after[:3, :3] @ before[:3, :3].T
    rotation = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    return np.concatenate([after[:3, 3] - before[:3, 3], rotation])


def test_at_home_the_flange_is_where_it_is_published_and_looks_ahead() -> None:
    pose = forward(ARM, np.zeros(6))
    np.testing.assert_allclose(pose[:3, 3], [0.515, 0.0, 0.712], atol=1e-15)
    np.testing.assert_allclose(pose[:3, 2], [1.0, 0.0, 0.0], atol=1e-15)


def test_frames_and_jacobian_equal_those_of_pinocchio() -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="pinocchio is not installed: pip install -e '.[pin]'")
    model, flange = pinocchio_model(pinocchio)
    data = model.createData()
    for angle, pose, matrix in zip(angles(200), forward(ARM, angles(200)), jacobian(ARM, angles(200)), strict=True):
        pinocchio.framesForwardKinematics(model, data, angle)
        pinocchio.computeJointJacobians(model, data, angle)
        place = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        np.testing.assert_allclose(pose, data.oMf[flange].homogeneous, rtol=0, atol=1e-12)
        theirs = pinocchio.getFrameJacobian(model, data, flange, place)
        np.testing.assert_allclose(matrix, theirs, rtol=0, atol=1e-12)


def pinocchio_model(pinocchio):  # type: ignore[no-untyped-def]
    """Build the same arm there, from rotations and translations one by one."""
    model = pinocchio.Model()
    parent, after = 0, pinocchio.SE3.Identity()

    def turned(axis: str, angle: float) -> object:
        return pinocchio.SE3(pinocchio.utils.rotate(axis, angle), np.zeros(3))

    for joint in range(6):
        placement = after * turned("z", ARM.offset[joint])
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), placement, f"joint_{joint + 1}")
        shift = pinocchio.SE3(np.eye(3), np.array([ARM.a[joint], 0.0, ARM.d[joint]]))
        after = shift * turned("x", ARM.alpha[joint])
    return model, model.addFrame(pinocchio.Frame("flange", parent, 0, after, pinocchio.FrameType.OP_FRAME))


def test_the_jacobian_is_the_derivative_of_the_pose() -> None:
    step = 1e-6
    for angle in angles(20):
        for joint in range(6):
            ahead, behind = (forward(ARM, angle + sign * step * np.eye(6)[joint]) for sign in (1, -1))
            slope = moved(behind, ahead) / (2 * step)
            np.testing.assert_allclose(jacobian(ARM, angle)[:, joint], slope, atol=1e-9)


def test_a_stack_of_angles_gives_what_one_set_after_the_other_gives() -> None:
    stack = angles(12).reshape(3, 4, 6)
    single = angles(12)
    np.testing.assert_array_equal(frames(ARM, stack).reshape(12, 7, 4, 4), [frames(ARM, angle) for angle in single])
    np.testing.assert_array_equal(jacobian(ARM, stack).reshape(12, 6, 6), [jacobian(ARM, angle) for angle in single])


def test_a_turn_about_a_joints_own_axis_is_its_column() -> None:
    angle = angles(1)[0]
    link = frames(ARM, angle)
    columns = turns(link[:-1, :3, 2], link[:-1, :3, 3], link[-1, :3, 3])
    np.testing.assert_allclose(columns.T, jacobian(ARM, angle), atol=1e-15)


def test_a_wrong_number_of_joints_is_refused() -> None:
    with pytest.raises(ValueError, match=r"shape \(4, 5\), must be \(\.\.\., 6\)"):
        jacobian(ARM, np.zeros((4, 5)))
