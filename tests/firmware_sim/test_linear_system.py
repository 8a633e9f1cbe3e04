"""A discrete system with dead time, alone and in a loop, against scipy and against its own frequency response."""

import numpy as np
import pytest
from scipy.signal import dlsim

from firmware_sim.plants.linear_system import LinearSystem

RNG = np.random.default_rng(5)
A = np.array([[0.9, 0.2, 0.0], [-0.2, 0.9, 0.1], [0.0, 0.0, 0.7]])
B, C, D = RNG.standard_normal((3, 2)), RNG.standard_normal((2, 3)), RNG.standard_normal((2, 2))
LATE = np.array([3, 0])


def system(delay: np.ndarray = LATE, dynamics: np.ndarray = A, direct: np.ndarray = D) -> LinearSystem:
    """Return two inputs and two outputs on three states at 10 samples/s."""
    return LinearSystem(dynamics, B, C, direct, delay, 10.0)


def test_it_runs_as_scipy_s_simulation_of_late_inputs() -> None:
    added = RNG.standard_normal((400, 2))
    late = np.stack([np.concatenate([np.zeros(3), added[:-3, 0]]), added[:, 1]], axis=1)
    _, wanted, _ = dlsim((A, B, C, D, 0.1), late)
    given, measured = system().run(added, np.zeros((400, 2)))
    np.testing.assert_allclose(measured, wanted, atol=1e-12)
    np.testing.assert_array_equal(given, added)


def test_noise_comes_to_the_output_and_goes_no_further() -> None:
    noise = RNG.standard_normal((50, 2))
    _, measured = system().run(np.zeros((50, 2)), noise)
    np.testing.assert_allclose(measured, noise)


def test_its_frequency_response_is_that_of_its_impulse_responses() -> None:
    frames = 4_096
    for source in range(2):
        added = np.zeros((frames, 2))
        added[0, source] = 1.0
        _, measured = system().run(added, np.zeros((frames, 2)))
        wanted = np.fft.rfft(measured, axis=0)[1:-1]
        np.testing.assert_allclose(
            system().response(np.fft.rfftfreq(frames, 0.1)[1:-1])[:, :, source], wanted, atol=1e-9
        )


def test_a_loop_holds_what_would_run_away_and_keeps_the_system_what_it_is() -> None:
    unstable = A.copy()
    unstable[2, 2] = 1.05
    wild = system(dynamics=unstable, direct=0 * D)
    added, silence = RNG.standard_normal((3_000, 2)), np.zeros((3_000, 2))
    _, alone = wild.run(added, silence)
    given, held = wild.run(added, silence, wild.loop(1.0, 1.0))
    assert np.abs(alone[-1]).max() > 1e20
    assert np.abs(held).max() < 1e3
    assert np.linalg.norm(given - added) > 0.1 * np.linalg.norm(added)
    late = np.stack([np.concatenate([np.zeros(3), given[:-3, 0]]), given[:, 1]], axis=1)
    state, wanted = np.zeros(3), np.zeros((200, 2))
    for n in range(200):
        wanted[n] = C @ state
        state = unstable @ state + B @ late[n]
    np.testing.assert_allclose(held[:200], wanted, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("delay", [np.array([0, 0]), np.array([5, 2])])
def test_the_dead_time_among_the_states_changes_nothing(delay: np.ndarray) -> None:
    a, b, c, d = system(delay).with_delay_inside()
    turn = np.exp(2j * np.pi * np.array([0.3, 2.0]) / 10)
    whole = np.array([c @ np.linalg.solve(z * np.eye(len(a)) - a, b) + d for z in turn])
    np.testing.assert_allclose(whole, system(delay).response(np.array([0.3, 2.0])))
