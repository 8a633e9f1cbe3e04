"""Coils, a structure with nonlinear elements in it, and sensors, against scipy's solvers and against energy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from firmware_sim.plants import exciter_kernel as kernel
from firmware_sim.plants.exciter import Coils, Exciter, ExciterPlant, linear_response, without_distortion
from firmware_sim.plants.mode_drift import Drift
from firmware_sim.plants.reception import Sensors, silent_reception
from firmware_sim.plants.structure import from_modes

RATE = 44_100
DELAY = 2e-3
FREQUENCY, DAMPING = np.array([22.0, 61.0, 240.0]), np.array([0.02, 0.01, 0.008])
COIL = np.array([[0.2, 0.15, 0.1], [0.2, -0.12, 0.13]])
JOINT, HEARD = np.array([[0.05, 0.1, -0.15]]), np.array([[0.15, 0.1, 0.2], [0.15, -0.1, 0.1]])


def vibrator(**changed: object) -> Exciter:
    """Return two coils and two sensors on three modes, linear and silent but for what is changed."""
    two = np.ones(2)
    coils = Coils(30.0 * two, 5.0 * two, 5.0 / (2 * np.pi * 800) * two, 0.0 * two, 0.0 * two, 4.0, 0.0, 1)
    sensors = Sensors(DELAY * two, 0.0 * two, 0.5 * two, np.zeros((2, 2)))
    structure = from_modes(FREQUENCY, DAMPING, np.concatenate([COIL, COIL, JOINT]), HEARD)
    whole = Exciter(structure, coils, without_distortion(3), silent_reception(sensors), Drift())
    return replace(whole, **changed)  # type: ignore[arg-type]


def run(exciter: Exciter, drive: np.ndarray, rate: float = RATE) -> np.ndarray:
    """Return what the sensors hear of a drive from rest, shape (frames, 2)."""
    heard = np.zeros((len(drive), 2))
    ExciterPlant(exciter, rate, 1).run(drive, heard)
    return heard


def nonlinear() -> Exciter:
    """Return the vibrator with every law at once, at about a millimetre."""
    laws = without_distortion(3)
    laws[:2, kernel.CUBIC], laws[:2, kernel.SAG] = 4e11, 1e-4
    laws[0, kernel.COULOMB], laws[0, kernel.TRAVEL] = 6.0, 2e-5
    laws[2, kernel.LUGRE : kernel.LUGRE + 6] = 4e5, 60.0, 10.0, 5.0, 8.0, 2e-3
    laws[1, kernel.STIFFNESS :] = 4e4, 5.0, -1e-4, 2e-4
    whole = vibrator()
    coils = replace(whole.coils, offset=np.full(2, 2e-4), width=np.full(2, 2e-3), clip=60.0, sharpness=2)
    return vibrator(elements=laws, coils=coils)


def test_its_linear_part_responds_as_the_formula_says() -> None:
    frames, exciter = 2**17, vibrator()
    response = np.zeros((frames // 2 + 1, 2, 2), complex)
    for coil in range(2):
        drive = np.zeros((frames, 2))
        drive[0, coil] = 1.0
        response[:, :, coil] = np.fft.rfft(run(exciter, drive), axis=0)
    frequency = np.fft.rfftfreq(frames, 1 / RATE)
    inside = (frequency > 5) & (frequency < 700)
    wanted = linear_response(exciter, frequency[inside])
    off = np.linalg.norm(response[inside] - wanted, axis=(1, 2)) / np.linalg.norm(wanted, axis=(1, 2))
    assert off.max() < 5e-3


def two_sines(time: np.ndarray | float) -> np.ndarray:
    """Return a drive, shape (2,) or (2, frames), V."""
    return np.array([12 * np.sin(2 * np.pi * 31 * time), 9 * np.sin(2 * np.pi * 47 * time + 1)])


def solved(exciter: Exciter, frames: int) -> np.ndarray:
    """Return the modes' coordinates of a fine solution of the same laws, shape (frames, 3), at the samples."""
    coils, laws, shapes = exciter.coils, exciter.elements, np.concatenate([COIL, COIL, JOINT])
    omega = 2 * np.pi * FREQUENCY
    offset, width = coils.offset[0], coils.width[0]

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        q, v, current, strain, bristle = state[:3], state[3:6], state[6:8], state[8], state[9]
        z, w = shapes @ q, shapes @ v
        voltage = coils.gain * two_sines(time)
        voltage = voltage / (1 + (voltage / coils.clip) ** 4) ** 0.25
        factor = coils.factor * np.exp((offset / width) ** 2 - ((z[:2] - offset) / width) ** 2)
        forces = np.zeros(5)
        forces[:2] = factor * current
        forces[2:4] -= laws[0, kernel.CUBIC] * z[2:4] ** 2 * (z[2:4] + 3 * laws[0, kernel.SAG])
        forces[2] -= laws[0, kernel.COULOMB] * strain
        near, far = laws[1, kernel.NEAR], laws[1, kernel.FAR]
        deep = max(z[3] - far, 0) + min(z[3] - near, 0)
        contact = laws[1, kernel.STIFFNESS] * deep + laws[1, kernel.CONTACT] * w[3]
        forces[3] -= max(contact, 0) if deep > 0 else min(contact, 0) if deep < 0 else 0
        sigma, damping, viscous, coulomb, static, slow = laws[2, kernel.LUGRE : kernel.LUGRE + 6]
        slip = w[4] - sigma * abs(w[4]) * bristle / (coulomb + (static - coulomb) * np.exp(-((w[4] / slow) ** 2)))
        forces[4] -= sigma * bristle + damping * np.exp(-((w[4] / slow) ** 2)) * slip + viscous * w[4]
        pace = coils.resistance / coils.inductance
        return np.concatenate(
            [
                v,
                forces @ shapes - omega**2 * q - 2 * DAMPING * omega * v,
                pace * ((voltage - factor * w[:2]) / coils.resistance - current),
                [w[2] / laws[0, kernel.TRAVEL] * (1 - strain * np.sign(w[2])), slip],
            ]
        )

    times = np.arange(frames) / RATE
    fine = solve_ivp(rates, (0, times[-1]), np.zeros(10), "DOP853", times, rtol=1e-6, atol=1e-10, max_step=5e-4)
    return fine.y[:3].T


def test_all_its_laws_together_move_it_as_a_fine_solution_does() -> None:
    """Of the motion, not the acceleration: positions at the sensors, the plant's by summing up twice."""
    frames = 12_000
    drive = np.ascontiguousarray(two_sines((np.arange(frames) + 0.5) / RATE).T)  # it is held from sample to sample
    exciter = nonlinear()
    wanted = solved(exciter, frames) @ HEARD.T
    late = round(DELAY * RATE)
    exact = replace(exciter.reception.sensors, delay=np.full(2, late / RATE))
    heard = run(vibrator(elements=exciter.elements, coils=exciter.coils, reception=silent_reception(exact)), drive)
    velocity = np.cumsum(heard, axis=0) / RATE
    place = np.cumsum(velocity, axis=0) / RATE  # at the end of each step, of accelerations at its middle
    moved = place[late:-1] - 0.5 * velocity[late:-1] / RATE
    off = np.sqrt(np.mean((moved - wanted[1 : frames - late]) ** 2)) / np.sqrt(np.mean(wanted**2))
    linear = run(vibrator(reception=silent_reception(exact)), drive)
    assert np.linalg.norm(linear - heard) > 0.1 * np.linalg.norm(heard)  # the laws matter
    assert off < 0.003


def energy_after_a_push(laws: np.ndarray, damping: float) -> np.ndarray:
    """Return linear energy in the modes second by second, J, of a push through coil 1 whose circuit then is open."""
    structure = from_modes(FREQUENCY, np.full(3, damping), np.concatenate([COIL, COIL, JOINT]), HEARD)
    whole = vibrator(elements=laws, structure=structure)
    coils = replace(whole.coils, resistance=np.full(2, 1e9), inductance=np.full(2, 1.0), gain=1e9)
    plant = ExciterPlant(replace(whole, coils=coils), RATE, 1)
    drive, heard = np.zeros((RATE // 4, 2)), np.zeros((RATE // 4, 2))
    drive[:400, 0] = 5.0
    energies = []
    for _ in range(8):
        plant.run(drive, heard)
        drive[:] = 0.0
        state = plant._state.reshape(2, -1)[:, :3]  # noqa: SLF001 (there is no other way to the energy)
        inlet = structure.outlet[0] * 0 + 1
        coordinates = (inlet * (state[0] + 1j * state[1])).real
        velocities = (structure.poles * (state[0] + 1j * state[1])).real
        energies.append(0.5 * (velocities**2 + (2 * np.pi * FREQUENCY * coordinates) ** 2).sum())
    return np.array(energies)


def test_without_losses_energy_stays() -> None:
    energies = energy_after_a_push(without_distortion(3), 0.0)
    np.testing.assert_allclose(energies, energies[0], rtol=1e-6)


def test_springs_and_backlash_neither_give_energy_nor_take_it_in_the_long_run() -> None:
    laws = without_distortion(3)
    laws[:2, kernel.CUBIC], laws[:2, kernel.SAG] = 4e11, 1e-4
    laws[2, kernel.STIFFNESS :] = 4e4, 0.0, -1e-5, 2e-5
    energies = energy_after_a_push(laws, 0.0)
    np.testing.assert_allclose(energies, energies[0], rtol=0.25)  # some of it is in the elements, to and fro
    assert abs(np.polyfit(np.arange(8), energies / energies[0], 1)[0]) < 0.02


@pytest.mark.parametrize("column", [kernel.COULOMB, kernel.LUGRE])
def test_friction_takes_energy_at_all_times(column: int) -> None:
    laws = without_distortion(3)
    if column == kernel.COULOMB:
        laws[0, kernel.COULOMB], laws[0, kernel.TRAVEL] = 3.0, 2e-5
    else:
        laws[2, kernel.LUGRE : kernel.LUGRE + 6] = 4e5, 60.0, 1.0, 3.0, 5.0, 2e-3
    energies = energy_after_a_push(laws, 0.0)
    assert (np.diff(energies) < 1e-9 * energies[0]).all()
    assert energies[-1] < 0.9 * energies[0]


def test_it_answers_the_same_in_one_piece_and_in_many() -> None:
    drive = np.random.default_rng(3).standard_normal((9_000, 2))
    whole = run(nonlinear(), drive)
    pieces, plant = np.zeros_like(drive), ExciterPlant(nonlinear(), RATE, 1)
    for start in range(0, 9_000, 500):
        plant.run(drive[start : start + 500], pieces[start : start + 500])
    np.testing.assert_array_equal(pieces, whole)


def test_it_stays_finite_whatever_the_drive() -> None:
    assert np.isfinite(run(nonlinear(), 1e4 * np.random.default_rng(3).standard_normal((RATE, 2)))).all()


@pytest.mark.parametrize(
    "drift", [Drift(trend=0.05, trend_seconds=1.0), Drift(jump_mode=1, jump_widths=3.0, jump_at=0.5)]
)
def test_drift_moves_what_is_heard(drift: Drift) -> None:
    drive = np.zeros((3 * RATE, 2))
    drive[[0, 2 * RATE], 0] = 1.0
    still, moved = run(vibrator(), drive), run(vibrator(drift=drift), drive)
    early, late = slice(0, RATE // 20), slice(2 * RATE, 3 * RATE)
    assert np.linalg.norm(moved[early] - still[early]) < 0.05 * np.linalg.norm(still[early])
    assert np.linalg.norm(moved[late] - still[late]) > 0.2 * np.linalg.norm(still[late])


def test_a_rate_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="rate is 100.0 samples/s, must be 8000 to 1e"):
        ExciterPlant(vibrator(), 100.0, 1)
