"""Shells, lumped exciters and flextensional rings have the resonances that textbooks give them."""

import numpy as np
import pytest
from scipy.linalg import eigh

from firmware_sim.plants.flextensional import NODES, Ring, chord, mount, radiation, ring_modes
from firmware_sim.plants.free_shell import BEAM, MOST_WAVES, Cylinder, axial, coupled_modes, shell_modes
from firmware_sim.plants.two_mass_exciter import Lumped, Spring, Unit, first_order, two_mass_exciters, with_loss

STEEL = 7850.0, 2.1e11, 0.3
SHELL = Cylinder(0.4, 1.2, 0.012, *STEEL)


def test_a_free_shell_s_lowest_modes_are_rayleigh_s_and_love_s() -> None:
    table = shell_modes(SHELL, np.zeros(MOST_WAVES))
    density, modulus, poisson = STEEL
    for waves in (2, 3, 5):
        n = waves**2
        slim = modulus * SHELL.thickness**2 / (12 * density * (1 - poisson**2) * SHELL.radius**4)
        rayleigh = np.sqrt(slim * n * (n - 1) ** 2 / (n + 1))
        stretch = (SHELL.radius / SHELL.length) ** 2
        love = rayleigh * np.sqrt((1 + 24 * (1 - poisson) * stretch / n) / (1 + 12 * stretch / (n * (n + 1))))
        for family, wanted in ((0, rayleigh), (1, love)):
            found = table.omega[(table.waves == waves) & (table.family == family)]
            np.testing.assert_allclose(found, [wanted, wanted])


def test_a_slender_tube_bends_as_a_beam() -> None:
    tube = Cylinder(0.05, 5.0, 0.002, *STEEL)
    table = shell_modes(tube, np.zeros(MOST_WAVES))
    found = table.omega[(table.waves == 1) & (table.family == 2)]
    wanted = (4.730041 / 5.0) ** 2 * np.sqrt(2.1e11 / 7850.0) * 0.05 / np.sqrt(2)
    np.testing.assert_allclose(found, wanted, rtol=0.05)  # the radius' ratio to the length slows it a little


def test_the_patterns_along_a_shell_are_a_free_beam_s() -> None:
    np.testing.assert_allclose(np.cos(BEAM), 1 / np.cosh(BEAM), atol=1e-6)
    place = np.linspace(-0.5, 0.5, 20_001)
    patterns = np.stack([axial(family, place) for family in range(6)])
    inner = (patterns @ patterns.T) / len(place)
    np.testing.assert_allclose(inner, np.diag([1, 1 / 3, 1, 1, 1, 1]), atol=2e-3)


def test_a_mass_on_a_spring_on_a_shell_couples_as_two_masses_do() -> None:
    """One rigid mode of 100 kg with 7 kg on it."""
    omega, shapes = coupled_modes(
        np.zeros(1), np.array([[0.1]]), np.array([7.0]), np.array([5e4]), np.zeros((0, 1)), np.zeros(0)
    )
    np.testing.assert_allclose(omega, [0.0, np.sqrt(5e4 * (1 / 7 + 1 / 100))], atol=1e-4)
    np.testing.assert_allclose(shapes.T @ np.diag([1.0, 7.0]) @ shapes, np.eye(2), atol=1e-12)


def test_two_masses_on_a_frame_ring_as_they_should() -> None:
    heavy = 1e9
    unit = Unit(20.0, 50.0, Spring(4e5, 0.0, 0.0, 0), Spring(2e6, 0.0, 0.0, 0))
    whole, reactions, plates = two_mass_exciters([unit], heavy, Spring(1e9, 0.0, 0.0, 0), [])
    masses, stiffness, _ = whole.matrices()
    squares = eigh(stiffness, np.diag(masses), eigvals_only=True)
    sum_, product = 4e5 / 20 + (4e5 + 2e6) / 50, 4e5 * 2e6 / (20 * 50)
    roots = np.sort(np.roots([1, -sum_, product]))
    np.testing.assert_allclose(squares[1:], roots, rtol=1e-6)
    assert (masses[reactions[0]], masses[plates[0]]) == (20.0, 50.0)


def test_a_spring_between_walls_surges_at_half_the_root_of_stiffness_over_mass() -> None:
    line = Lumped()
    wall = line.body(1e12)
    line.join(wall, -1, Spring(3e5, 0.0, 2.0, 60))
    masses, stiffness, _ = line.matrices()
    frequency = np.sqrt(eigh(stiffness, np.diag(masses), eigvals_only=True)[1:3]) / (2 * np.pi)
    np.testing.assert_allclose(frequency, 0.5 * np.sqrt(3e5 / 2.0) * np.array([1, 2]), rtol=0.03)


def test_springs_lose_the_same_part_of_every_mode_and_dashpots_more_of_some() -> None:
    unit = Unit(20.0, 50.0, Spring(4e5, 0.0, 2.0, 3), Spring(2e6, 0.0, 2.0, 2))
    whole, *_ = two_mass_exciters([unit, unit], 300.0, Spring(1e6, 0.0, 0.0, 0), [Spring(1e5, 0.0, 0.0, 0)])
    masses, stiffness, damping = whole.matrices()
    poles = np.linalg.eigvals(first_order(masses, stiffness, with_loss(masses, stiffness, damping, 0.007)))
    np.testing.assert_allclose(-poles.real / np.abs(poles), 0.007, rtol=1e-6)
    damped = Unit(20.0, 50.0, Spring(4e5, 60.0, 2.0, 3), unit.lower)
    whole, *_ = two_mass_exciters([damped], 300.0, Spring(1e6, 0.0, 0.0, 0), [])
    masses, stiffness, damping = whole.matrices()
    poles = np.linalg.eigvals(first_order(masses, stiffness, with_loss(masses, stiffness, damping, 0.007)))
    ratio = -poles.real / np.abs(poles)
    assert ratio.min() > 0.00699
    assert ratio.max() > 0.012


def circle(radius: float, thickness: float, ends: float = 0.0) -> Ring:
    """Return a circular steel ring, a metre high."""
    return Ring(radius, radius, np.full(NODES, thickness), 1.0, 7850.0, 2.1e11, ends)


def test_a_ring_in_water_has_the_bending_modes_of_the_formula_with_the_water_s_mass() -> None:
    radius, thickness = 0.5, 0.02
    modes = ring_modes(circle(radius, thickness), [], 10)
    np.testing.assert_allclose(modes.omega[:3], 0.0, atol=1e-2)  # it floats
    for waves, found in zip((2, 2, 3, 3, 4, 4), modes.omega[3:9], strict=True):
        wall = 7850.0 * thickness * (1 + 1 / waves**2) + 1000.0 * radius / waves
        bending = 2.1e11 * thickness**3 / 12 * (waves**2 - 1) ** 2 / radius**4
        assert found == pytest.approx(np.sqrt(bending / wall), rel=0.01)


def test_a_ring_s_modes_are_normalised_and_bending_displaces_no_volume_of_a_circle() -> None:
    modes = ring_modes(circle(0.5, 0.02), [], 12)
    assert np.abs(modes.volume[3:9]).max() < 1e-3 * np.abs(modes.normal[:, 3:9]).max()
    assert modes.area == pytest.approx(2 * np.pi * 0.5, rel=0.005)


def test_a_spring_across_a_ring_or_to_the_ground_stiffens_it() -> None:
    ring = circle(0.5, 0.02, ends=5.0)
    free = ring_modes(ring, [], 6).omega
    across = ring_modes(ring, [(chord(0, NODES // 2, ring), 1e8)], 6).omega
    held = ring_modes(ring, [(mount(node, axis), 1e6) for node in (5, 20, 33) for axis in range(2)], 6).omega
    assert across[4] > 1.05 * free[3]
    assert (held[:3] > 10).all()
    stretch = chord(3, 27, ring).reshape(NODES, 3)
    assert np.linalg.norm(stretch[3, :2]) == pytest.approx(1.0)
    assert (stretch[3] == -stretch[27]).all()


def test_a_small_source_radiates_what_a_pulsating_sphere_does() -> None:
    """Resistance rho c (k a)^2 and mass rho a per area at low frequency; rho c at high."""
    pull, corner = radiation(4 * np.pi * 0.3**2)
    area, radius = 4 * np.pi * 0.3**2, 0.3
    for frequency in (20.0, 20_000.0):
        omega = 2 * np.pi * frequency
        impedance = pull * area * (1j * omega / corner) / (1 + 1j * omega / corner)
        ka = omega * radius / 1500.0
        assert impedance.real == pytest.approx(1000.0 * 1500.0 * ka**2 / (1 + ka**2))
        assert impedance.imag == pytest.approx(1000.0 * 1500.0 * ka / (1 + ka**2))
