"""G_R from chirps: the path that carries them, the model that is fitted, and what is refused."""

import numpy as np
import pytest

from calibration.milling.chirp_path import ChirpPath
from calibration.milling.response_fit import fit_response
from calibration.milling.robot_fit import fit_axis, simulated
from stagectl.robot.pocket_config import Pocket
from tests.stagectl.robot.milling.trial_models import RATE, axis

CHIRPS = ChirpPath(10e-3, 0.6, 1.5e-3, 8.0, 0.3, 27.5, 70e-3)


def test_no_direction_turns_around_while_a_chirp_runs() -> None:
    path = CHIRPS.path(Pocket())
    for direction in range(3):
        for held_back, sign in ((False, 1.0), (True, -1.0)):
            part = CHIRPS.part(Pocket(), direction, held_back)
            speed = sign * np.diff(path.wanted[part, direction]) * RATE
            assert speed.min() > 0.0
            assert speed.max() < 2 * CHIRPS.feed


def test_the_path_is_one_without_jumps_and_ends_where_it_began() -> None:
    wanted = CHIRPS.path(Pocket()).wanted
    assert np.linalg.norm(np.diff(wanted, axis=0), axis=1).max() * RATE < 0.025
    assert wanted[0] == pytest.approx([0.0, 0.0, 70e-3])
    assert wanted[-1] == pytest.approx(wanted[0], abs=1e-12)


@pytest.mark.parametrize("delay", [0, 2, 5])
def test_a_model_of_third_order_is_found_again_from_its_response(delay: int) -> None:
    true, frequency = axis(delay), np.linspace(0.3, 25.0, 80)
    found = fit_response(frequency, true.response(frequency), np.ones(80), RATE)
    assert found.response(frequency) == pytest.approx(true.response(frequency), abs=1e-5)


def test_a_noisy_sharp_resonance_gives_a_stable_model() -> None:
    frequency = np.linspace(0.3, 25.0, 80)
    mode = np.exp(2j * np.pi * frequency * -0.016) / (1 - (frequency / 10.0) ** 2 + 0.06j * frequency / 10.0)
    noise = 0.1 * np.random.default_rng(2).standard_normal((2, 80))
    found = fit_response(frequency, mode + noise[0] + 1j * noise[1], np.ones(80), RATE)
    assert np.abs(np.roots(found.denominator)).max() < 1.0
    assert np.abs(found.response(frequency) - mode).mean() < 0.5


def test_both_chirps_tell_the_model_in_noise() -> None:
    true = axis(3, 0.3)
    drives = tuple(CHIRPS.chirp(falling) for falling in (False, True))
    rng = np.random.default_rng(4)
    answers = tuple(simulated(true, each) + 2e-6 * rng.standard_normal(len(each)) for each in drives)
    found = fit_axis(drives, answers, RATE, 25.0, 10.0)
    low = found.frequency < 10.0
    off = np.abs(found.model.response(found.frequency) - true.response(found.frequency))
    assert off[low].max() < 0.03
    assert found.fresh > 95.0
    assert (
        np.abs(found.measured - true.response(found.frequency))[low] < np.maximum(2 * found.spread[low], 0.02)
    ).all()


def test_a_robot_that_does_not_follow_is_refused() -> None:
    drives = tuple(CHIRPS.chirp(falling) for falling in (False, True))
    still = tuple(np.zeros(len(each)) for each in drives)
    with pytest.raises(ValueError, match="the robot moved by 0 mm where it was asked for"):
        fit_axis(drives, still, RATE, 25.0, 10.0)
