"""Moving coils against their small-signal formula, scipy's solver, energy, and the laws of harmonics."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from firmware_sim.plants import moving_coil_kernel as kernel
from firmware_sim.plants.moving_coil import (
    Heating,
    LargeSignal,
    Motor,
    Moving,
    MovingCoil,
    MovingCoilPlant,
    machine_tables,
    steps_of_a_sample,
)
from firmware_sim.plants.moving_coil_response import gas_stiffness, linear_response
from firmware_sim.plants.reception import Sensors, silent_reception
from firmware_sim.plants.suspension_drift import Softening, SuspensionDrift

RATE = 44_100
Slopes = Callable[[np.ndarray, np.ndarray], np.ndarray]
DELAY = 1e-3
TWO = np.ones(2)
MODES = np.array(
    [[[180.0, 0.01, 0.2, -0.7], [310.0, 0.02, -0.8, 1.2]], [[190.0, 0.01, -0.1, 0.5], [300.0, 0.02, 0.6, 1.0]]]
)
CREEP = np.tile([[400.0, 300.0], [300.0, 30.0], [200.0, 3.0]], (2, 1, 1))
LOUD = LargeSignal(
    4e-3, (0.1, 0.12), (0.1, -0.15), (0.1, 0.1, 0.1), 0.4, 0.25, 3.0, 0.5, ((4e4, 0.5), (2e4, 0.5), (1e4, 0.5))
)


def vibrator(**changed: object) -> MovingCoil:
    """Return two units of 0.2 kg that face apart, linear, cold and silent but for what is changed."""
    motor = Motor(4.0, np.array([8.0, 8.4]), np.array([5.0, 5.2]), 8e-4 * TWO, 3.0 * TWO, 6e-4 * TWO)
    moving = Moving(
        np.array([0.2, 0.21]), np.array([5e3, 4.8e3]), 3.0 * TWO, CREEP, 0.02 * TWO, np.array([1.0, -1.0]), MODES,
        3.0, 1.5e3, 6.0, 1.2e5, 0.02, 1.4,
    )  # fmt: skip
    sensors = Sensors(DELAY * TWO, 0.0 * TWO, 0.5 * TWO, np.zeros((2, 2)))
    still = LargeSignal(offset=(0.0, 0.0))
    whole = MovingCoil(motor, moving, still, Heating(), Softening(), silent_reception(sensors))
    return replace(whole, **changed)  # type: ignore[arg-type]


def run(whole: MovingCoil, drive: np.ndarray, rate: float = RATE) -> np.ndarray:
    """Return what the sensors hear of a drive from rest, shape (frames, units)."""
    heard = np.zeros_like(drive)
    MovingCoilPlant(whole, rate, 1).run(drive, heard)
    return heard


def noise(frames: int, size: float, seed: int = 3) -> np.ndarray:
    """Return a drive of `size` V that has little above 500 Hz, shape (frames, 2)."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal((frames, 2)), axis=0)
    spectrum /= 1 + (np.fft.rfftfreq(frames, 1 / RATE) / 150)[:, None] ** 4
    drive = np.fft.irfft(spectrum, frames, axis=0)
    return np.ascontiguousarray(size * drive / np.abs(drive).max())


@pytest.mark.sample(1)
@pytest.mark.parametrize("rate", [16_000, 44_100, 96_000])
def test_a_small_drive_makes_what_the_impedances_say(rate: int) -> None:
    """With all that is nonlinear but the seal, at a level where none of it matters."""
    frames, whole = 6 * rate, vibrator(large=replace(LOUD, seal=()))
    response = np.zeros((frames // 2 + 1, 2, 2), complex)
    for coil in range(2):
        drive = np.zeros((frames, 2))
        drive[0, coil] = 1e-3
        response[:, :, coil] = np.fft.rfft(run(whole, drive, rate), axis=0) / 1e-3
    frequency = np.fft.rfftfreq(frames, 1 / rate)
    inside = (frequency > 5) & (frequency < 650)
    wanted = linear_response(whole, frequency[inside])
    held = np.sinc(frequency[inside] / rate)[:, None, None]  # what holding the drive takes away
    error = np.abs(response[inside] / held - wanted)
    assert (error / np.abs(wanted).max(axis=(1, 2), keepdims=True)).max() < 0.01


def test_alone_in_a_heavy_housing_it_is_the_loudspeaker_of_the_textbook() -> None:
    """(Bl / Z) s^2 / (s^2 M + s R + K + s Bl^2 / Z), with one stiffness of suspension and gas."""
    whole = vibrator()
    moving = replace(
        whole.moving, modes=MODES[:, :0], creep=CREEP[:, :0], housing=1e9, mount=1e9, area=0.02 * np.array([1.0, 0.0])
    )
    motor, s = whole.motor, 2j * np.pi * np.array([8.0, 25.0, 90.0, 400.0])
    electric = motor.resistance[0] + s * 8e-4 + 1 / (1 / 3.0 + 1 / (s * 6e-4))
    stiffness = moving.stiffness[0] + 1.4 * 1.2e5 * 0.02**2 / 0.02
    mechanic = s**2 * moving.mass[0] + s * 3.0 + stiffness + s * motor.factor[0] ** 2 / electric
    wanted = motor.gain * motor.factor[0] / electric * s**2 / mechanic * np.exp(-s * DELAY)
    frequency = s.imag / (2 * np.pi)
    np.testing.assert_allclose(linear_response(replace(whole, moving=moving), frequency)[:, 0, 0], wanted, rtol=1e-6)
    assert gas_stiffness(moving)[0, 0] == pytest.approx(1.4 * 1.2e5 * 0.02)


def slopes_of(whole: MovingCoil) -> tuple[tuple[int, int], Slopes]:
    """Return the shape of the state, and its slopes as a function of the state, raveled, and voltage; no seal."""
    machine = machine_tables(whole)
    shape = 3, kernel.CREPT + CREEP.shape[1] + 2 * MODES.shape[1]
    seal, places = (np.zeros((2, len(whole.large.seal))), np.zeros(2)), np.zeros((2, 2))

    def slopes(state: np.ndarray, voltage: np.ndarray) -> np.ndarray:
        slope = np.zeros(shape)
        kernel.fill_slopes(state.reshape(shape), slope, voltage, machine, whole.motor.resistance, seal, places)
        return slope.ravel()

    return shape, slopes


@pytest.mark.sample(1)
@pytest.mark.parametrize("rate", [RATE, 2 * RATE])
def test_at_large_signals_it_follows_an_adaptive_solver(rate: int) -> None:
    whole = vibrator(large=replace(LOUD, seal=()))
    shape, slopes = slopes_of(whole)
    frames = rate // 20
    drive = np.repeat(noise(RATE // 20, 12.0), rate // RATE, axis=0)
    state, heard, largest = np.zeros(shape).ravel(), np.zeros((frames, 2)), 0.0
    for n in range(frames):
        voltage = 4.0 * drive[n]
        half, end = (
            solve_ivp(lambda _, y, u=voltage: slopes(y, u), (0, part / rate), state, "RK45", rtol=1e-8, atol=1e-12).y[
                :, -1
            ]
            for part in (0.5, 1.0)
        )
        moved = slopes(half, voltage).reshape(shape)
        heard[n] = moved[:2, kernel.V] + (MODES[:, :, 3] * moved[:2, -2:]).sum(axis=1)
        state, largest = end, max(largest, np.abs(end.reshape(shape)[:2, kernel.Y]).max())
    assert largest > 0.7 * LOUD.excursion
    mine, late = run(whole, drive, rate), round(DELAY * rate)
    error = mine[late + 40 : frames - 40] - heard[40 : frames - 40 - late]
    assert np.abs(error).max() < 0.01 * np.abs(heard).max()


def test_halving_the_step_changes_little_of_a_loud_run() -> None:
    """Seals and all: at twice the rate, and four times."""
    whole, drive = vibrator(large=LOUD), noise(RATE // 2, 10.0)
    runs = [run(whole, np.repeat(drive, times, axis=0), times * RATE) for times in (1, 3, 9)]
    middle = [each[times // 2 :: times] for each, times in zip(runs, (1, 3, 9), strict=True)]
    errors = [np.sqrt(np.mean((each - middle[2]) ** 2) / np.mean(middle[2] ** 2)) for each in middle[:2]]
    assert errors[0] < 2e-3
    assert errors[1] < 0.5 * errors[0]


def stored(whole: MovingCoil, state: np.ndarray, held: np.ndarray) -> float:
    """Return the energy of a state, J, from the laws as integrals and not as the kernel has them."""
    moving, motor, large = whole.moving, whole.motor, whole.large
    count = MODES.shape[1]
    bent, rate = state[:2, -2 * count : -count], state[:2, -count:]
    x = state[:2, kernel.Y] - moving.facing * state[2, kernel.Y] + (MODES[:, :, 2] * bent).sum(axis=1)
    z, (p, q, r) = x / large.excursion, large.spring
    omega = 2 * np.pi * MODES[:, :, 0]
    energy = 0.5 * (moving.mass * state[:2, kernel.V] ** 2).sum() + 0.5 * moving.housing * state[2, kernel.V] ** 2
    energy += 0.5 * moving.mount * state[2, kernel.Y] ** 2
    energy += 0.5 * (moving.mass[:, None] * (rate**2 + omega**2 * bent**2)).sum()
    relaxed = moving.stiffness - CREEP[:, :, 0].sum(axis=1)
    energy += (0.5 * relaxed * x**2 + moving.stiffness * x**2 * (p * z / 3 + q * z**2 / 4 + r * z**4 / 6)).sum()
    crept = state[:2, kernel.CREPT : kernel.CREPT + CREEP.shape[1]]
    energy += 0.5 * (CREEP[:, :, 0] * (x[:, None] - crept) ** 2).sum()
    swept = moving.area @ x / moving.volume
    energy += moving.pressure * moving.volume * (((1 + swept) ** -0.4 - 1) / 0.4 + swept)
    inside = 1 - large.modulation * z / np.sqrt(1 + z**2)
    i, share = state[:2, kernel.CURRENT], large.saturating
    root = np.sqrt(1 + (i / large.saturation) ** 2)
    energy += (
        motor.inductance * inside * (0.5 * (1 - share) * i**2 + share * large.saturation**2 * (1 - 1 / root))
    ).sum()
    energy += 0.5 * (motor.iron_inductance * inside * state[:2, kernel.EDDY] ** 2).sum()
    energy += (
        sum(0.5 * held[:, j] ** 2 / stiffness for j, (stiffness, _) in enumerate(large.seal)).sum() if large.seal else 0
    )
    return float(energy)


def test_it_stores_no_more_than_it_was_given_and_loses_it_without_drive() -> None:
    whole, rate = vibrator(large=LOUD), 4 * RATE
    machine = machine_tables(whole)
    shape = 3, kernel.CREPT + CREEP.shape[1] + 2 * MODES.shape[1]
    state, hot, held = np.zeros(shape), whole.motor.resistance.copy(), np.zeros((2, 3))
    memory = state, np.zeros((2, 2)), hot, (held, np.zeros(2)), np.zeros(2)
    work = np.zeros((5, *shape)), np.zeros(2), np.zeros((2, 2)), np.zeros(shape)
    timing = 1 / rate, 1
    drive, heard = np.repeat(noise(RATE // 4, 14.0), 4, axis=0), np.zeros((1, 2))
    given, before, losses = 0.0, np.zeros(2), []
    for n in range(len(drive)):
        kernel.run_moving_coils(drive[n : n + 1], heard, 4.0, machine, np.array([0.0, 1, 0, 1]), memory, timing, work)
        given += float(4.0 * drive[n] @ (before + state[:2, kernel.CURRENT]) / 2 / rate)
        before = state[:2, kernel.CURRENT].copy()
        if n % 200 == 0:
            losses.append(given - stored(whole, state, held))
    assert np.diff(losses).min() > -1e-6 * given
    assert losses[-1] > 0.5 * given
    energies = []
    for _ in range(300):
        kernel.run_moving_coils(
            np.zeros((100, 2)), np.zeros((100, 2)), 4.0, machine, np.array([0.0, 1, 0, 1]), memory, timing, work
        )
        energies.append(stored(whole, state, held))
    assert np.diff(energies).max() <= 1e-9 * energies[0]
    assert energies[-1] < 0.05 * energies[0]


def harmonics(large: LargeSignal, size: float, **changed: object) -> np.ndarray:
    """Return the first five harmonics at the first sensor of a sine of 30 Hz and `size` V, m/s^2."""
    drive = size * np.sin(2 * np.pi * 30 * np.arange(3 * RATE) / RATE)[:, None] * TWO
    heard = run(vibrator(large=large, **changed), np.ascontiguousarray(drive))[-RATE:, 0]
    return np.abs(np.fft.rfft(heard))[30:180:30] * 2 / RATE


ODD = LargeSignal(4e-3, (0.1, 0.1), (0.0, 0.0), (0.0, 0.2, 0.1))
EVEN = LargeSignal(4e-3, (0.1, 0.1), (0.2, 0.2), (0.15, 0.1, 0.0), 0.3, 0.0, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("large", "order"), [(ODD, 3), (EVEN, 2)])
def test_harmonics_grow_with_level_as_their_order_says(large: LargeSignal, order: int) -> None:
    """Doubling the level doubles the second harmonic over the first, and makes the third four times that."""
    ratios = [harmonics(large, size)[order - 1] / harmonics(large, size)[0] for size in (0.3, 0.6)]
    assert ratios[1] / ratios[0] == pytest.approx(2 ** (order - 1), rel=0.1)
    assert ratios[1] > 1e-5


def test_a_coil_in_the_middle_of_its_field_has_odd_harmonics_only_but_for_the_gas() -> None:
    moving = vibrator().moving
    roomy = replace(moving, area=1e3 * moving.area, volume=1e6 * moving.volume)  # as stiff, and hardly compressed
    tight, airy = harmonics(ODD, 3.0), harmonics(ODD, 3.0, moving=roomy)
    assert airy[1] < 0.01 * airy[2]
    assert tight[1] > 5 * airy[1]


def test_friction_of_a_seal_is_worst_when_faint() -> None:
    """As a part of the whole: the reverse of what all else does."""
    large = replace(LargeSignal(offset=(0.0, 0.0)), seal=((4e4, 0.02), (2e4, 0.02)))
    faint, loud = (harmonics(large, size) for size in (0.5, 4.0))
    assert faint[2] / faint[0] > 3 * loud[2] / loud[0]


def test_a_coil_warms_up_and_gets_fainter() -> None:
    drive = np.ascontiguousarray(2.0 * np.sin(2 * np.pi * 80 * np.arange(6 * RATE) / RATE)[:, None] * TWO)
    power = 4.0**2 * 2.0**2 / 2 / 5.0
    heard = run(vibrator(heating=Heating(50.0 / power, 1.0, 0.0, 1.0)), drive)
    early, late = (np.abs(heard[part]).max() for part in (slice(3_000, 6_000), slice(-5_000, None)))
    assert 0.80 < late / early < 0.93


def test_a_suspension_softens_with_work_recovers_and_wanders() -> None:
    drift, factor = SuspensionDrift(Softening(0.1, 10.0), 2, 1), np.ones(2)
    for _ in range(100):
        drift.step(1.0, np.array([0.05, 0.0]), factor)
    np.testing.assert_allclose(factor, [0.95, 1.0], atol=1e-4)
    for _ in range(100):
        drift.step(1.0, np.zeros(2), factor)
    np.testing.assert_allclose(factor, 1.0, atol=1e-3)
    walking = SuspensionDrift(Softening(walk=0.01), 400, 1)
    factor = np.ones(400)
    for _ in range(240):
        walking.step(1.0, np.zeros(400), factor)
    assert np.log(factor).std() == pytest.approx(0.02, rel=0.1)


def test_a_slow_sample_is_made_of_more_steps() -> None:
    steps = [steps_of_a_sample(machine_tables(vibrator(large=LOUD)), rate) for rate in (8_000.0, 44_100.0, 192_000.0)]
    assert all(count % 2 == 1 for count in steps)
    assert steps[0] > steps[2] == 1


def test_frames_of_any_length_make_the_same_run() -> None:
    whole, drive = vibrator(large=LOUD, softening=Softening(0.1, 1.0, 0.01)), noise(9_000, 8.0)
    plant, heard = MovingCoilPlant(whole, RATE, 1), np.zeros((9_000, 2))
    for start in range(0, 9_000, 700):
        plant.run(drive[start : start + 700], heard[start : start + 700])
    np.testing.assert_array_equal(heard, run(whole, drive))
