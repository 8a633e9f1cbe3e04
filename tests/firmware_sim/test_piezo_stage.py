"""The simulated piezo stage against what is known of the real one."""

import numpy as np
import pytest

from firmware_sim.plants.piezo_stage import LASER_STEP, PiezoStagePlant
from firmware_sim.plants.piezo_stage_modes import PIEZO_STIFFNESS
from tests.firmware_sim.stage_runs import RATE, X, Y, Z, opening, run, sweep

SEEDS = range(1, 21)
QUIET = {"noise": 0.0, "delay": 0}


def _gains(plant: PiezoStagePlant) -> np.ndarray:
    """Return each mode's share of plate over free expansion at rest, shape (plate, stack, modes)."""
    modes = plant.modes
    shares: np.ndarray = PIEZO_STIFFNESS * modes.plate[:, None] * modes.extension / (2 * np.pi * modes.frequency) ** 2
    return shares


@pytest.mark.parametrize("seed", SEEDS)
def test_three_two_and_one_resonances_lie_below_150_hz_and_the_first_between_50_and_80(seed: int) -> None:
    """Sörnmo 2015, fig. 2.10; a resonance counts with 3 % or more of the axis' static gain."""
    plant = PiezoStagePlant(RATE, seed=seed)
    gains = _gains(plant)
    for axis, count in ((X, 3), (Y, 2), (Z, 1)):
        counts = np.abs(gains[axis, axis]) > 0.03 * gains[axis, axis].sum()
        main = np.sort(plant.modes.frequency[counts & (plant.modes.frequency < 150)])
        assert len(main) == count
        assert 50 <= main[0] <= 80


@pytest.mark.parametrize("seed", SEEDS)
def test_gear_ratio_travel_and_loop_are_those_of_the_thesis(seed: int) -> None:
    """Ratio about 5, travel 400 to 500 um, loops of 15 to 23 % of the span."""
    extension, position, _ = run(PiezoStagePlant(RATE, seed=seed, **QUIET), sweep(1.0, 0.0, 1000.0, 2.0))
    last = slice(round(RATE), None)
    travel = np.ptp(position[last], axis=0)
    ratio = travel / np.ptp(extension[last], axis=0)
    widest = opening(extension, 1.0)
    assert np.all((travel > 400e-6) & (travel < 500e-6))
    assert np.all((ratio > 4.3) & (ratio < 5.3))
    assert np.all((widest > 0.15) & (widest < 0.23))


def test_the_loop_narrows_with_amplitude() -> None:
    """A few per cent at small signals [PI Ceramic]; amplitude dependence as in fig. 2.9."""
    small, _, _ = run(PiezoStagePlant(RATE, **QUIET), sweep(1.0, 450.0, 550.0, 2.0))
    large, _, _ = run(PiezoStagePlant(RATE, **QUIET), sweep(1.0, 300.0, 700.0, 2.0))
    assert np.all(opening(small, 1.0) < 0.07)
    assert np.all(opening(large, 1.0) > 0.09)


def test_the_loop_widens_with_rate_by_more_than_amplifier_and_levers_lag() -> None:
    """Rate dependence as in fig. 2.9: from 1 to 10 Hz, against a stage of the same lags without loops."""
    widening = []
    for hysteresis in (1.0, 0.0):
        slow, fast = (
            opening(run(PiezoStagePlant(RATE, hysteresis=hysteresis, creep=0.0, **QUIET), wave)[0], frequency)
            for frequency, wave in ((rate, sweep(rate, 300.0, 700.0, 3.0)) for rate in (1.0, 10.0))
        )
        widening.append(fast - slow)
    assert np.all(widening[0] > widening[1] + 0.002)


def test_a_loop_without_hysteresis_and_creep_is_closed() -> None:
    """What is left is the amplifier's and the levers' lag."""
    plant = PiezoStagePlant(RATE, hysteresis=0.0, creep=0.0, **QUIET)
    extension, _, _ = run(plant, sweep(1.0, 0.0, 1000.0, 2.0))
    assert np.all(opening(extension, 1.0) < 2e-3)


def test_a_constant_voltage_creeps_at_about_two_hundredths_of_a_micrometre_a_second() -> None:
    """Sörnmo 2015, sec. 2.3: 0.02 um/s; here between 10 and 30 s after half the range."""
    voltage = np.full((round(30 * RATE), 3), 500.0)
    extension, _, _ = run(PiezoStagePlant(RATE, **QUIET), voltage)
    speed = (extension[-1] - extension[round(10 * RATE)]) / 20
    assert np.all((speed > 0.01e-6) & (speed < 0.03e-6))
    still, _, _ = run(PiezoStagePlant(RATE, creep=0.0, **QUIET), voltage)
    assert np.all(np.abs(still[-1] - still[round(10 * RATE)]) < 5e-9)  # the gauges' step is 2.1 nm


def test_a_process_force_bends_the_stage_by_its_static_compliance_and_loads_the_stack() -> None:
    plant = PiezoStagePlant(RATE, **QUIET)
    force = np.zeros((round(3 * RATE), 3))
    force[:, Y] = 100.0
    extension, position, _ = run(plant, np.zeros_like(force), force)
    compliance = np.sum((plant.modes.plate / (2 * np.pi * plant.modes.frequency)) ** 2, axis=1)
    np.testing.assert_allclose(position[-1, Y], 100 * compliance[Y], atol=20e-9)
    assert 0.2e-6 < compliance[Y] < 0.3e-6
    assert extension[-1, Y] > 0.5e-6
    assert np.all(np.abs(position[:, [X, Z]]) < 10e-9)


def test_x_and_z_are_coupled_a_little_and_y_is_not() -> None:
    """Random steps on x: z moves by some hundredths, y by nothing that its sensor shows."""
    voltage = np.zeros((round(5 * RATE), 3))
    voltage[:, X] = 500 + 50 * np.repeat(np.random.default_rng(3).choice([-1.0, 1.0], len(voltage) // 20), 20)
    _, position, _ = run(PiezoStagePlant(RATE, **QUIET), voltage)
    moved = np.std(position[round(RATE) :], axis=0)
    assert 0.01 * moved[X] < moved[Z] < 0.3 * moved[X]
    assert moved[Y] < 10e-9


def test_the_frequency_scale_moves_every_mode_and_keeps_what_is_static() -> None:
    nominal, higher = PiezoStagePlant(RATE), PiezoStagePlant(RATE, frequency_scale=1.05)
    np.testing.assert_allclose(higher.modes.frequency, 1.05 * nominal.modes.frequency)
    np.testing.assert_allclose(_gains(higher), _gains(nominal), atol=1e-12)


def test_the_recursion_is_exact_for_a_held_force() -> None:
    """A step of force against the modal sum's closed form."""
    plant = PiezoStagePlant(RATE, **QUIET)
    modes, samples = plant.modes, 300
    force = np.zeros((samples, 3))
    force[:, Z] = 1000.0
    _, position, _ = run(plant, np.zeros_like(force), force)
    omega, zeta = 2 * np.pi * modes.frequency, modes.damping
    time = np.arange(1, samples + 1)[:, None] / RATE
    ringing = omega * np.sqrt(1 - zeta**2)
    decay = np.exp(-zeta * omega * time) * (np.cos(ringing * time) + zeta * omega / ringing * np.sin(ringing * time))
    expected = 1000 * (1 - decay) @ (modes.plate[Z] / omega) ** 2
    np.testing.assert_allclose(position[:, Z], expected, atol=6e-9)  # half a step of the sensor


def test_the_sensors_have_the_noise_the_steps_and_the_delay_that_are_written_down() -> None:
    voltage = np.zeros((20_000, 3))
    extension, position, absolute = run(PiezoStagePlant(RATE), voltage)
    np.testing.assert_allclose(np.std(extension, axis=0), 15e-9, rtol=0.05)
    np.testing.assert_allclose(np.std(position, axis=0), 25e-9, rtol=0.05)
    steps = absolute / LASER_STEP
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    assert 0.05e-6 < np.std(absolute) < 0.2e-6
    jump = np.full((50, 3), 500.0)
    prompt, late = (run(PiezoStagePlant(RATE, noise=0.0, delay=delay), jump)[0] for delay in (0, 3))
    np.testing.assert_array_equal(late[3:], prompt[:-3])


def test_the_laser_sees_the_robot_one_of_its_cycles_late_and_the_plate_does_not() -> None:
    base = np.zeros((100, 3))
    base[40:] = 50e-6
    _, position, absolute = run(PiezoStagePlant(RATE, noise=0.0, laser_rate=2_000.0), np.zeros((100, 3)), None, base)
    seen = int(np.argmax(absolute[:, X] > 25e-6))
    assert 5 <= seen - 40 <= 10
    assert np.all(absolute[seen:] == pytest.approx(50e-6))
    assert np.all(np.abs(position) < 10e-9)


def test_two_stages_of_one_seed_are_alike_and_of_two_seeds_are_not() -> None:
    voltage = sweep(20.0, 0.0, 800.0, 0.2)
    first, again, other = (run(PiezoStagePlant(RATE, seed=seed), voltage) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first[0], other[0])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"frequency_scale": 2.0}, "frequency_scale is 2.0, must be 0.5 to 1.5"),
        ({"delay": 1.5}, "delay is 1.5, must be a whole number 0 to 100"),
        ({"laser_rate": 20_000.0}, "laser_rate is 20000.0, must be at most 10000 Hz"),
        ({"rate": 100.0}, "rate is 100.0 samples/s, must be 5000 to 100000"),
    ],
)
def test_a_wrong_option_is_refused_by_name(options: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        PiezoStagePlant(**{"rate": RATE, **options})  # type: ignore[arg-type]
