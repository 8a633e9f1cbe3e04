"""Hysteresis of stacks against solvers of their equations, and against the properties by which its laws are known."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from firmware_sim.plants import hysteresis_kernel as kernel
from firmware_sim.plants.stack_hysteresis import Hysteresis, bouc_wen, maxwell_slip, prandtl_ishlinskii

THRESHOLD = np.array([0.01, 0.04, 0.09, 0.15, 0.22, 0.31, 0.4])
DENSITY = np.array([1.0, 2.0, 1.5, 1.0, 0.7, 0.4, 0.3])
LAWS = {
    "bouc-wen": bouc_wen(0.2, 0.7, 0.3, 1.5),
    "prandtl-ishlinskii": prandtl_ishlinskii(0.2, THRESHOLD, DENSITY),
    "maxwell-slip": maxwell_slip(0.2, THRESHOLD, DENSITY, 0.0),
}
MEMORY = {name: LAWS[name] for name in ("prandtl-ishlinskii", "maxwell-slip")}


def line(*corners: float) -> np.ndarray:
    """Go from corner to corner in steps of 1/1000 of the range."""
    parts = [np.linspace(a, b, round(1000 * abs(b - a)) + 1)[1:] for a, b in zip(corners, corners[1:], strict=False)]
    return np.concatenate([[corners[0]], *parts])


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_whole_range_is_gone_through_whole_and_the_slope_changes_by_as_much_as_it_is_told(law: Hysteresis) -> None:
    along = law.trace(line(0.0, 1.0, 0.0, 1.0))
    up = along[-1001:]
    assert up[-1] - up[0] == pytest.approx(1.0, abs=2e-3)
    slope = np.diff(up) * 1000
    assert slope.min() > 0
    assert (slope.max() - slope.min()) / (slope.max() + slope.min()) == pytest.approx(0.2, abs=0.03)
    opening = np.max(along[1000:2001][::-1] - up)
    assert 0.05 < opening < 0.2


def test_bouc_wen_is_what_a_solver_makes_of_its_equation() -> None:
    law = LAWS["bouc-wen"]
    growth, beta, gamma, power, slope = law.numbers
    time = np.linspace(0.0, 3.0, 3001)

    def wave(t: float) -> tuple[float, float]:
        return 0.5 - 0.5 * np.exp(-0.3 * t) * np.cos(2 * np.pi * t), 0.5 * np.exp(-0.3 * t) * (
            0.3 * np.cos(2 * np.pi * t) + 2 * np.pi * np.sin(2 * np.pi * t)
        )

    def change(t: float, state: np.ndarray) -> list[float]:
        speed, (h,) = wave(t)[1], state
        return [growth * speed - abs(h) ** power * (beta * abs(speed) * np.sign(h) + gamma * speed)]

    solved = solve_ivp(change, (0.0, 3.0), [0.0], t_eval=time, rtol=1e-10, atol=1e-12, max_step=1e-3)
    voltage = wave(time)[0]
    np.testing.assert_allclose(law.trace(voltage), slope * voltage - solved.y[0], atol=1e-6)


def test_a_charge_is_what_a_solver_makes_of_its_equation() -> None:
    delay = 2e-3
    law = maxwell_slip(0.2, THRESHOLD, DENSITY, delay)
    time = np.arange(6000) * 1e-4
    voltage = 0.5 - 0.5 * np.cos(2 * np.pi * 5 * time) * np.exp(-time)
    volts = lambda t: np.interp(t, time, voltage)  # noqa: E731

    def change(t: float, state: np.ndarray) -> np.ndarray:
        speed = (volts(t) - state[0] - state[1:].sum()) / delay
        slides = (np.abs(state[1:]) >= law.threshold) & (state[1:] * speed > 0)
        return np.concatenate([[speed], np.where(slides, 0.0, law.weight * speed)])

    start = np.zeros(1 + len(THRESHOLD))
    solved = solve_ivp(change, (0.0, time[-1]), start, t_eval=time, rtol=1e-6, atol=1e-8, max_step=2e-4, method="RK23")
    np.testing.assert_allclose(law.trace(voltage, 1e-4), law.numbers[kernel.SLOPE] * solved.y[0], atol=4e-3)


@pytest.mark.parametrize("law", MEMORY.values(), ids=MEMORY)
def test_a_minor_loop_closes_and_is_forgotten(law: Hysteresis) -> None:
    """Return-point memory, or wiping out: [Mayergoyz, Mathematical Models of Hysteresis, 1991, sec. 1.2]."""
    detour, straight = law.trace(line(0, 0.9, 0.3, 0.6, 0.3, 0.8)), law.trace(line(0, 0.9, 0.3, 0.8))
    there = [0, 900, 1500, 1800, 2100]
    assert detour[there[4]] == pytest.approx(detour[there[2]], abs=1e-9)
    np.testing.assert_allclose(detour[2100:], straight[1500:], atol=1e-9)


def test_minor_loops_between_the_same_voltages_are_congruent() -> None:
    law = LAWS["prandtl-ishlinskii"]
    low, high = (law.trace(line(0, start, 0.4, 0.6, 0.4))[-401:] for start in (0.7, 1.0))
    np.testing.assert_allclose(low - low[0], high - high[0], atol=1e-9)
    assert abs(low[0] - high[0]) > 1e-3


def test_bouc_wen_does_not_forget_a_minor_loop() -> None:
    """By which it differs from sums of plays."""
    law = LAWS["bouc-wen"]
    detour, straight = law.trace(line(0, 0.9, 0.3, 0.6, 0.3, 0.8)), law.trace(line(0, 0.9, 0.3, 0.8))
    assert np.abs(detour[2100:] - straight[1500:]).max() > 1e-3


def test_bristles_are_what_a_solver_makes_of_a_mass_on_a_guide() -> None:
    """A mass on a spring, driven through break-away and back; LuGre friction [Canudas de Wit et al. 1995]."""
    numbers = np.array([2e6, 200.0, 5.0, 4.0, 6.0, 2e-3])
    stiffness, mass, step = 1e6, 10.0, 2e-5

    def push(t: float) -> float:
        return 20.0 * np.sin(2 * np.pi * 3 * t)

    def change(t: float, state: np.ndarray) -> list[float]:
        place, speed, z = state
        level = numbers[3] + (numbers[4] - numbers[3]) * np.exp(-((speed / numbers[5]) ** 2))
        turning = speed - numbers[0] * abs(speed) / level * z
        drag = numbers[0] * z + numbers[1] * turning + numbers[2] * speed
        return [speed, (push(t) - stiffness * place - 600.0 * speed - drag) / mass, turning]

    time = np.arange(25_000) * step
    solved = solve_ivp(change, (0.0, time[-1]), [0.0] * 3, t_eval=time, rtol=1e-7, atol=1e-12, method="LSODA")
    place = speed = z = 0.0
    found = np.empty(len(time))
    for n, t in enumerate(time):
        found[n] = place
        drag, z = kernel.bristles(speed, step, z, numbers)
        speed += step * (push(t) - stiffness * place - 600.0 * speed - drag) / mass
        place += step * speed
    np.testing.assert_allclose(found, solved.y[0], atol=0.01 * np.ptp(solved.y[0]))
    assert np.ptp(solved.y[0]) > 20e-6
