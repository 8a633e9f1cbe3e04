"""A joint's turn from poses of its links, wherever the tracked frames sit on them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from calibration.joint_clamping.results import LINK, JointResult, seen_tool
from calibration.joint_clamping.torque_map import TorqueMap
from calibration.joint_clamping.tracked_links import link_motion, tool_pose, tracked_axis
from ctlblocks.recording import Recording
from stagectl.robot.arm import irb140
from stagectl.robot.kinematics import frames

ARM = irb140().with_tool(0.1)
NOISE = 6e-4
"""rad of a pose's direction."""


def seen(angle: np.ndarray, noise: float = 0.0, seed: int = 1) -> Recording:
    """Return what a tracker sees of base, links and tool, each frame turned and moved on its link by chance."""
    random = np.random.default_rng(seed)
    mounted = Rotation.random(8, random_state=3)
    links = frames(ARM, angle)
    whole = np.concatenate([links, links[:, -1:]], axis=1)
    columns = [angle]
    for number in range(8):
        turn = Rotation.from_matrix(whole[:, number, :3, :3]) * mounted[number]
        turn = Rotation.from_rotvec(noise * random.standard_normal((len(angle), 3))) * turn
        quaternion = turn.as_quat()[:, [3, 0, 1, 2]]
        columns += [whole[:, number, :3, 3], quaternion * random.choice([-1.0, 1.0], len(angle))[:, None]]
    names = [f"angle_{joint}" for joint in range(1, 7)] + [f"frames_{place}" for place in range(1, 57)]
    return Recording(tuple(names), ("1",) * 62, 250.0, np.hstack(columns))


def approach() -> np.ndarray:
    return np.linspace(0.0, 1.0, 200)[:, None] * np.radians([20.0, 30.0, -30.0, 40.0, 1.0, 20.0])


@pytest.mark.parametrize("joint", [0, 2, 5])
def test_a_joints_turn_is_seen_whatever_else_moves(joint: int) -> None:
    axis = tracked_axis(seen(approach(), NOISE), joint)
    assert axis is not None
    moved = np.tile(np.radians([20.0, 30.0, -30.0, 40.0, 50.0, 20.0]), (300, 1))
    moved += 2e-3 * np.sin(np.linspace(0, 7, 300))[:, None] * np.arange(1, 7)
    found = link_motion(seen(moved), axis, joint)
    assert found is not None
    wanted = moved[:, joint] - moved[:, joint].mean()
    np.testing.assert_allclose(found, wanted, atol=5e-3 * np.ptp(wanted))


def test_a_joint_that_did_not_turn_has_no_axis_and_a_frame_that_is_hidden_no_motion() -> None:
    way = seen(approach())
    assert tracked_axis(way, 4) is None  # 1 deg
    axis = tracked_axis(way, 2)
    assert axis is not None
    data = way.data.copy()
    data[:150, 6 + 7 * 3 : 6 + 7 * 4] = 0.0
    hidden = Recording(way.names, way.units, way.rate, data)
    assert link_motion(hidden, axis, 2) is None
    assert tracked_axis(hidden, 2) is None
    assert tool_pose(hidden) is not None


def test_samples_in_between_that_were_not_seen_are_filled() -> None:
    way = seen(approach())
    data = way.data.copy()
    data[50:60, 6 + 7 * 7 :] = 0.0
    tool = seen_tool(Recording(way.names, way.units, way.rate, data))
    whole = seen_tool(way)
    assert tool is not None
    assert whole is not None
    np.testing.assert_allclose(tool[:, :3], whole[:, :3], atol=2e-4)
    assert np.abs(np.linalg.norm(tool[:, 3:], axis=1) - 1).max() < 1e-3


def test_a_link_whose_angle_is_not_the_motors_has_no_axis() -> None:
    """Frames that are taken for each other, such as that of a link and that of the one after the next."""
    way = seen(approach())
    data = way.data.copy()
    data[:, 2] *= 1.1
    assert tracked_axis(Recording(way.names, way.units, way.rate, data), 2) is None


def test_a_way_that_is_chosen_and_not_there_is_named() -> None:
    bare = TorqueMap(np.linspace(0, 1, 200), np.linspace(0, 1, 200), 250.0)
    with pytest.raises(ValueError, match='joint 3 has no model "by the link\'s motion", there are '):
        _ = JointResult(2, bare, {}, LINK).best
