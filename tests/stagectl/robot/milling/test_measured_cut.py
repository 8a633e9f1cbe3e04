"""How a cut answers to the tool's speed, found from one trial, and a law that goes by it."""

from dataclasses import replace

import numpy as np
import pytest

from stagectl.robot.milling.learning import PathLaw, correction, update
from stagectl.robot.milling.measured_cut import MeasuredCut, cutting_gain, velocity
from stagectl.robot.milling.trial_error import TrialSignals, measured_cut
from tests.stagectl.robot.milling.trial_models import RATE, axis, process, square

PATH = square()
SLOT = np.array([[-2e3, 9e2, 0.0], [-9e2, -2e3, 0.0], [0.0, 0.0, 0.0]])
"""Force over velocity, N s/m: against the way, and to its side."""
LAW = PathLaw((axis(2), axis(3, 0.3), axis(2, -0.5)), process())
MOVES = np.linalg.norm(velocity(PATH, RATE), axis=1) > 8e-3


def test_velocity_is_that_of_the_path_without_delay() -> None:
    np.testing.assert_allclose(velocity(PATH, RATE)[1:-1], (PATH[2:] - PATH[:-2]) * RATE / 2, atol=2e-4)


def test_a_cut_that_is_everywhere_the_same_is_found_where_the_tool_moves() -> None:
    found = cutting_gain(velocity(PATH, RATE) @ SLOT.T, PATH, RATE)
    np.testing.assert_allclose(found[MOVES], np.broadcast_to(SLOT, found[MOVES].shape), atol=0.15 * 2e3)
    assert np.abs(found[:100]).max() < 0.05 * 2e3  # it rests there, and nothing can be told


def test_a_cut_of_half_the_way_is_found_there_and_not_in_the_other_half() -> None:
    half = np.arange(len(PATH)) < len(PATH) // 2
    found = cutting_gain(velocity(PATH, RATE) @ SLOT.T * half[:, None], PATH, RATE)
    near = np.abs(np.arange(len(PATH)) - len(PATH) // 2) < RATE / 2
    np.testing.assert_allclose(found[MOVES & half & ~near, 0, 0], -2e3, rtol=0.15)
    assert np.abs(found[MOVES & ~half & ~near]).max() < 0.01 * 2e3


def test_a_force_along_z_follows_the_speed_along_the_path_whichever_way_it_goes() -> None:
    speed = np.linalg.norm(velocity(PATH, RATE), axis=1)
    found = cutting_gain(np.outer(speed, [0.0, 0.0, 500.0]), PATH, RATE)
    way = velocity(PATH, RATE) / np.maximum(speed, 1e-9)[:, None]
    np.testing.assert_allclose(np.einsum("nj,nj->n", found[:, 2], way)[MOVES], 500.0, rtol=0.2)
    assert np.abs(found[:, :2]).max() < 1e-9
    assert np.abs(found[:, :, 2]).max() == 0.0


def test_a_law_that_goes_by_a_measured_cut_is_that_of_free_space_where_nothing_is_cut() -> None:
    cut = MeasuredCut(np.zeros((len(PATH), 3, 3)), process().compliance)
    error = 1e-4 * np.random.default_rng(1).standard_normal(PATH.shape)
    np.testing.assert_allclose(
        update(PATH, error, LAW, cut), update(PATH, error, PathLaw(LAW.axes)), rtol=0, atol=1e-15
    )


def test_a_law_by_a_cut_as_the_model_has_it_is_the_law_by_the_model() -> None:
    """But for the ends, where this error does not rest; the model's force is behind by some milliseconds."""
    flat = process().force.frequency_response(np.array([0.2]))[0] / (2j * np.pi * 0.2)
    cut = MeasuredCut(np.broadcast_to(flat.real, (len(PATH), 3, 3)), process().compliance)
    error = 1e-4 * np.sin(2 * np.pi * 0.5 * np.arange(len(PATH)) / RATE)[:, None] * [1.0, -0.5, 0.8]
    by_cut, by_model, in_air = (
        correction(error, law, given)[500:-500] for law, given in ((LAW, cut), (LAW, None), (PathLaw(LAW.axes), None))
    )
    assert np.abs(by_cut - by_model).max() < 0.2 * np.abs(in_air - by_model).max()


@pytest.mark.parametrize("method", [1, 2, 3])
def test_every_method_sees_the_same_cut_in_a_trial_without_noise(method: int) -> None:
    kinematic = np.full(PATH.shape, 2e-5)
    still = LAW.process
    assert still is not None
    at_rest = still.compliance.frequency_response(np.zeros(1))[0].real
    force = velocity(PATH, RATE) @ SLOT.T
    bent = force @ at_rest.T
    trial = TrialSignals(PATH, PATH - bent, PATH + kinematic, force)
    found = measured_cut(trial, method, RATE, still, kinematic)
    if method != 1:  # these know where the tool is from G_K, which is behind the force by 30 ms
        assert np.median(np.abs(found.gain[MOVES, 0, 0] + 2e3)) < 0.2 * 2e3
        return
    change = 1e-4 * np.sin(2 * np.pi * 0.5 * np.arange(len(PATH)) / RATE)[:, None] * [1.0, -0.5, 0.0]
    right = velocity(change, RATE) @ (at_rest @ SLOT).T
    off = (found.deflection(change, RATE) - right)[MOVES, :2]
    bound = 0.5 * np.sqrt(np.mean(right[MOVES, :2] ** 2))  # this arm bends by another factor along y than along x
    assert np.sqrt(np.mean(off**2)) < bound


def test_method_1_sees_the_cut_whatever_the_compliance_is_believed_to_be() -> None:
    still = LAW.process
    assert still is not None
    softer = replace(
        still, compliance=replace(still.compliance, C=-7.0 * still.compliance.C, D=-7.0 * still.compliance.D)
    )
    trial = TrialSignals(PATH, PATH - 1e-3 * velocity(PATH, RATE), PATH)
    one, other = (measured_cut(trial, 1, RATE, each, np.zeros_like(PATH)).gain for each in (still, softer))
    np.testing.assert_array_equal(one, other)
    assert np.abs(one).max() > 0.0
