"""A structure by its poles, against the matrices that it came from."""

import numpy as np
import pytest
from scipy.linalg import eigh

from firmware_sim.plants.structure import Structure, from_modes, from_state_space

MASS = np.diag([3.0, 5.0, 2.0])
SPRING = 1e5 * np.array([[3.0, -1.0, 0.0], [-1.0, 4.0, -2.0], [0.0, -2.0, 2.5]])
PLACES, HEARD = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, -1.0]]), np.array([[0.0, 0.0, 1.0]])
OMEGA = 2 * np.pi * np.array([3.0, 20.0, 31.0, 55.0, 200.0])


def impedance(damping: np.ndarray) -> np.ndarray:
    """Return displacement per force at `OMEGA` from the matrices."""
    return np.linalg.inv(-(OMEGA[:, None, None] ** 2) * MASS + 1j * OMEGA[:, None, None] * damping + SPRING)


def test_modes_respond_as_their_matrices_do() -> None:
    squares, shapes = eigh(SPRING, MASS)
    ratio = np.array([0.01, 0.03, 0.002])
    structure = from_modes(np.sqrt(squares) / (2 * np.pi), ratio, PLACES @ shapes, HEARD @ shapes)
    modal = MASS @ shapes @ np.diag(2 * ratio * np.sqrt(squares)) @ shapes.T @ MASS
    wanted = impedance(modal)
    near, heard = structure.response(OMEGA, 0, 2)
    np.testing.assert_allclose(near, PLACES @ wanted @ PLACES.T, rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(heard, HEARD @ wanted @ PLACES.T, rtol=1e-9, atol=1e-14)
    _, faster = structure.response(OMEGA, 2, 1)
    np.testing.assert_allclose(faster, -(OMEGA[:, None, None] ** 2) * heard[:, :, :1], rtol=1e-12)
    np.testing.assert_allclose(structure.damping, ratio, rtol=1e-9)
    np.testing.assert_allclose(structure.frequency, np.sqrt(squares) / (2 * np.pi), rtol=1e-9)


def general() -> tuple[Structure, np.ndarray]:
    """Return a structure with two real poles beside oscillations, and its response at `OMEGA`."""
    dashpots = np.diag([900.0, 30.0, 8000.0])
    dynamics = np.block(
        [[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(MASS, SPRING), -np.linalg.solve(MASS, dashpots)]]
    )
    inlet = np.concatenate([np.zeros((3, 2)), np.linalg.solve(MASS, PLACES.T)])
    outlet = np.concatenate([PLACES, np.zeros((2, 3))], axis=1)
    seen = np.concatenate([HEARD, np.zeros((1, 3))], axis=1)
    resolvent = np.linalg.inv(1j * OMEGA[:, None, None] * np.eye(6) - dynamics)
    return from_state_space(dynamics, inlet, outlet, seen), np.concatenate([outlet, seen]) @ resolvent @ inlet


def test_any_dynamics_respond_as_their_matrices_do_with_real_poles_among_them() -> None:
    structure, wanted = general()
    assert (structure.poles.imag == 0).sum() == 2
    np.testing.assert_allclose(np.concatenate(structure.response(OMEGA, 0, 2), axis=1), wanted, rtol=1e-8)


def test_moved_poles_are_other_springs_on_the_same_masses() -> None:
    squares, shapes = eigh(SPRING, MASS)
    structure = from_modes(np.sqrt(squares) / 6.28, np.full(3, 0.02), PLACES @ shapes, HEARD @ shapes)
    stiffer = structure.moved(np.full(3, 1.1))
    _, before = structure.response(np.array([1e6]), 2, 2)
    _, after = stiffer.response(np.array([1e6]), 2, 2)
    np.testing.assert_allclose(
        after, before, atol=1e-4 * np.abs(before).max()
    )  # masses alone, so far above the resonances
    _, soft = structure.response(np.array([1e-3]), 0, 2)
    _, stiff = stiffer.response(np.array([1e-3]), 0, 2)
    np.testing.assert_allclose(stiff, soft / 1.21, rtol=1e-6)


def test_a_smaller_structure_of_the_same_form_is_lighter_and_faster() -> None:
    structure, _ = general()
    half = structure.resized(2.0)
    np.testing.assert_allclose(half.frequency, 2 * structure.frequency)
    np.testing.assert_allclose(half.damping, structure.damping)
    _, whole = structure.response(OMEGA, 2, 2)
    _, small = half.response(2 * OMEGA, 2, 2)
    np.testing.assert_allclose(small, 8 * whole, rtol=1e-9)  # mass goes with the cube of size


@pytest.mark.parametrize("kept", [[0], [1, 2]])
def test_what_is_left_out_is_missing(kept: list[int]) -> None:
    squares, shapes = eigh(SPRING, MASS)
    structure = from_modes(np.sqrt(squares) / 6.28, np.full(3, 0.02), PLACES @ shapes, HEARD @ shapes)
    parts = [structure.kept(np.array(some)).response(OMEGA, 0, 2)[1] for some in (kept, sorted({0, 1, 2} - set(kept)))]
    np.testing.assert_allclose(parts[0] + parts[1], structure.response(OMEGA, 0, 2)[1])
