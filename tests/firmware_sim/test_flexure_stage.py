"""The stage on flexures against what scipy makes of its linear part, and against a solver where a guide rubs."""

import numpy as np
import pytest
from scipy import signal
from scipy.integrate import solve_ivp

from firmware_sim.plants.creep import chain, logarithmic
from firmware_sim.plants.flexure_stage import FlexureStage, FlexureStagePlant, Guide, Modes, Sensor, Stack
from firmware_sim.plants.stack_hysteresis import Hysteresis, bouc_wen, straight

FREQUENCY, DAMPING = np.array([60.0, 63.0, 180.0, 90.0, 390.0, 75.0]), np.array([0.01, 0.02, 0.01, 0.02, 0.005, 0.01])
OWNER, SHARE = np.array([0, 0, 0, 1, 1, 2]), np.array([0.7, 0.4, -0.1, 1.1, -0.1, 1.0])
STIFFNESS, LEVER = 1e8, 4.0
NO_CREEP = chain([1.0], [0.0])


def modes() -> Modes:
    omega, own = 2 * np.pi * FREQUENCY, np.eye(3)[:, OWNER]
    part = 0.8 * np.abs(SHARE) / np.bincount(OWNER, np.abs(SHARE))[OWNER]
    shape = omega * np.sqrt(part / STIFFNESS)
    plate = SHARE * LEVER * omega**2 / (STIFFNESS * shape)
    return Modes(FREQUENCY, DAMPING, own * shape, (own + 0.02) * plate, np.full(3, STIFFNESS), np.full(3, 0.05))


def stage(law: Hysteresis, guides: tuple[Guide, ...] = (), **changes: object) -> FlexureStage:
    stack = Stack((0.0, 150.0), 50e-6, 0.0, 1000.0, 500.0, 1e9, law, NO_CREEP)
    quiet = Sensor(0.0, 1e-15, (-1.0, 1.0), np.ones(3), 2000.0)
    given = {"delay": 0, "laser_delay": 0, "laser_rate": 1e9, "seed": 1} | changes
    return FlexureStage((stack,) * 3, guides, modes(), quiet, quiet, quiet, **given)  # type: ignore[arg-type]


def run(
    rate: float, made: FlexureStage, voltage: np.ndarray, force: np.ndarray | None = None
) -> tuple[np.ndarray, ...]:
    rest, found = np.zeros_like(voltage), tuple(np.zeros_like(voltage) for _ in range(3))
    FlexureStagePlant(rate, made).run(voltage, rest if force is None else force, rest, *found)
    return found


@pytest.mark.parametrize("axis", range(3))
def test_its_linear_part_is_what_scipy_makes_of_lags_modes_and_filters(axis: int) -> None:
    """From each stack to all plates and gauges, 20 to 450 Hz: within 0.5 % of the largest, phase included."""
    rate, samples = 50_000.0, 2**17
    pulse = np.zeros((samples, 3))
    pulse[100, axis] = 50.0
    extension, position, _ = run(rate, stage(straight()), pulse)
    frequency = np.fft.rfftfreq(samples, 1 / rate)
    band = (frequency > 20) & (frequency < 450)
    late = np.exp(2j * np.pi * frequency[band] * 100 / rate)
    s = 2j * np.pi * frequency[band]
    chains = signal.zpk2tf([], [-2 * np.pi * corner for corner in (1000, 500, 2000, 2000)], 1.0)
    low = signal.freqs(*chains, worN=2 * np.pi * frequency[band])[1] / signal.freqs(*chains, worN=[0.0])[1]
    low *= np.exp(-0.5 * s / rate) * np.exp(1.0 * s / rate)  # held over a sample; its end is shown
    made = modes()
    own = made.stiffness[axis] * made.extension[axis]
    for output, shape, direct in ((extension, made.extension, 0.05), (position, made.plate, 0.0)):
        for to in range(3):
            found = np.fft.rfft(output[:, to])[band] * late / 50.0
            systems = zip(own * shape[to], made.damping, 2 * np.pi * made.frequency, strict=True)
            expected = sum(
                signal.freqs([gain], [1, 2 * z * w, w**2], worN=s.imag)[1] for gain, z, w in systems if gain != 0.0
            ) + direct * (to == axis)
            expected = expected * low * 50e-6 / 150.0
            assert np.abs(found - expected).max() < 0.005 * np.abs(expected).max() + 1e-12, (axis, to)


def test_a_force_on_the_plate_shows_on_the_gauge_as_much_as_an_expansion_on_the_plate() -> None:
    """Betti's law: the modes are reciprocal."""
    made, rate = stage(straight()), 10_000.0
    push = np.zeros((40_000, 3))
    push[:, 0] = 1.0
    extension = run(rate, made, np.zeros_like(push), push)[0][-1, 0]
    position = run(rate, made, 150.0 * push)[1][-1, 0]
    assert extension / 1.0 == pytest.approx(position / (50e-6 * STIFFNESS), rel=1e-6)


def test_creep_and_hysteresis_add_as_they_are_told() -> None:
    stack = Stack((0.0, 150.0), 50e-6, 0.0, 5e3, np.inf, 1e9, bouc_wen(0.2, 0.7, 0.3, 1.0), logarithmic(0.02, 0.01))
    made = stage(straight())
    made = FlexureStage((stack,) * 3, *(getattr(made, name) for name in list(made.__dataclass_fields__)[1:]))
    voltage = np.zeros((200_000, 3))
    voltage[1000:] = 100.0
    position = run(10_000.0, made, voltage)[1][:, 2]
    grown = position[199_000] - position[20_800]  # 1.98 s to 19.8 s
    at_once = (
        50e-6 * stack.hysteresis.trace(np.linspace(0, 100 / 150, 500))[-1] * LEVER * 1.06
    )  # its own, and of each other
    assert grown == pytest.approx(0.02 * at_once, rel=0.02)


@pytest.mark.slow
def test_a_guide_rubs_as_a_solver_has_it() -> None:
    """One mode under a force that breaks the guide away and turns round."""
    guide = Guide(2e6, 300.0, 5.0, 4.0, 6.0, 2e-3)
    still = Modes(np.array([60.0, 300.0, 310.0]), np.full(3, 0.02), np.eye(3), 0.3 * np.eye(3), np.ones(3), np.zeros(3))
    made = stage(straight(), (guide,) * 3)
    made = FlexureStage(
        made.stacks, made.guides, still, *(getattr(made, n) for n in list(made.__dataclass_fields__)[3:])
    )
    rate, omega = 40_000.0, 2 * np.pi * 60.0
    time = np.arange(30_000) / rate
    push = np.zeros((len(time), 3))
    push[:, 0] = 40.0 * np.sin(2 * np.pi * 4 * time) * np.minimum(time / 0.1, 1.0)

    def change(t: float, state: np.ndarray) -> list[float]:
        place, speed, z = state[0], state[1], state[2]
        moving = 0.3 * speed
        level = guide.coulomb + (guide.stiction - guide.coulomb) * np.exp(-((moving / guide.stribeck) ** 2))
        turning = moving - guide.bristle * abs(moving) / level * z
        drag = guide.bristle * z + guide.loss * turning + guide.viscous * moving
        force = np.interp(t, time, push[:, 0]) - drag
        low = [2 * np.pi * 2000.0 * (a - b) for a, b in ((0.3 * place, state[3]), (state[3], state[4]))]
        return [speed, 0.3 * force - 2 * 0.02 * omega * speed - omega**2 * place, turning, *low]

    solved = solve_ivp(change, (0.0, time[-1]), np.zeros(5), t_eval=time, rtol=1e-7, atol=1e-13, method="LSODA")
    found = run(rate, made, np.zeros_like(push), push)[1][:, 0]
    span = np.ptp(solved.y[4])
    np.testing.assert_allclose(found, solved.y[4], atol=0.01 * span)
    assert np.abs(solved.y[2]).max() > 0.95 * guide.coulomb / guide.bristle
