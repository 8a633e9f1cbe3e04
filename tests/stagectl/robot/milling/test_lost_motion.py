"""Lost motion: how far links stay behind motors that turn around, what a path carries of it, and what denies it."""

import numpy as np
import pytest

from stagectl.experiments.trials.trial import first_trial, tool_arm
from stagectl.robot.config import CellConfig
from stagectl.robot.kinematics import jacobian
from stagectl.robot.milling.lost_motion import LostMotion
from stagectl.robot.milling.trial_error import TrialSignals

RATE = 250.0
CELL = first_trial(CellConfig(), "pocket28").cell
ARM = tool_arm(CELL)
LOST = LostMotion(np.array([1e-4, 0.0, 0.0, 0.0, 2e-4, 0.0]))
AT = np.arange(3_000) / RATE
TURN = np.sin(2 * np.pi * 0.25 * AT)[:, None] * [0.01, 0.01, 0.0, 0.0, 0.02, 0.0]
"""rad: to and fro three times."""
ANGLE = np.array(CELL.pocket.home) + TURN
WHOLE = np.ones(len(AT), bool)


def seen(share: float, noise: float = 2e-5) -> TrialSignals:
    """Return what a tracker sees of a tool whose links stay behind by that share of the lost motion."""
    behind = -share * np.einsum("nij,nj->ni", jacobian(ARM, ANGLE)[:, :3], LOST.lead(ANGLE))
    joints = np.zeros((len(AT), 3))
    return TrialSignals(joints, joints, behind + noise * np.random.default_rng(1).standard_normal(behind.shape))


def test_a_link_follows_its_motor_as_a_play_operator() -> None:
    lead = LOST.lead(ANGLE)
    assert lead[0] == pytest.approx(0.0)
    assert lead[200, 0] == pytest.approx(1e-4)  # on the way out
    assert lead[400, 0] == pytest.approx(-1e-4)  # on the way back
    links = ANGLE - lead
    turned = np.flatnonzero(np.diff(np.sign(np.diff(ANGLE[:, 0]))))[0]
    assert np.ptp(links[turned + 2 : turned + 12, 0]) < 1e-9  # it rests until the gap is crossed
    assert np.abs(lead[:, [1, 2, 3, 5]]).max() == 0.0


def test_a_path_carries_it_smoothly_and_within_the_speed_of_its_joints() -> None:
    carried = LOST.carried(ANGLE, RATE, 10.0, np.full(6, 1.0))
    assert np.abs(carried[:, 0]).max() == pytest.approx(1e-4, rel=0.15)
    assert np.abs(carried - LOST.lead(ANGLE)).mean() < 1e-5
    fastest = np.abs(np.diff(ANGLE, axis=0)).max(axis=0) * RATE + [1e-4, 1.0, 1.0, 1.0, 1.0, 1.0]
    slower = LOST.carried(ANGLE, RATE, 10.0, fastest)
    speed = np.abs(np.diff(ANGLE + slower, axis=0)).max(axis=0) * RATE
    assert (speed <= fastest).all()
    assert np.abs(slower[:, 0]).max() < 0.5e-4
    np.testing.assert_array_equal(slower[:, 4], carried[:, 4])


def test_a_tracker_that_sees_it_has_it_stay() -> None:
    assert LOST.refusal(ARM, ANGLE, seen(1.0), WHOLE, RATE) == ""


@pytest.mark.parametrize("share", [0.0, -1.0, 4.0])
def test_a_tracker_that_sees_another_one_denies_it(share: float) -> None:
    assert "is taken out of the path again" in LOST.refusal(ARM, ANGLE, seen(share), WHOLE, RATE)
