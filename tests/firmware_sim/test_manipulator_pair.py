"""The pair of manipulators against what scipy makes of its linear parts, and its limits one by one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from firmware_sim.plants.manipulator_pair import Macro, ManipulatorPair, ManipulatorPairPlant, Micro

RATE = 250.0
POLES = (complex(-8.0), complex(-3.0, 4.0), complex(-3.0, -4.0), complex(-20.0))
MACRO = Macro(0.0, 1e6, 1, 1e3, POLES, 5.0, 0.05, 0.3)
MICRO = Micro(5.0, 1e3, 2.0, 0.02, 30.0, 0.03, 0.1, 1e3)
PAIR = ManipulatorPair(MACRO, MICRO, (0.0, 0.0, 0.0), 1)


def run(pair: ManipulatorPair, fast: np.ndarray, slow: np.ndarray, **events: float) -> dict[str, np.ndarray]:
    names = ("relative", "fast", "slow", "control", "position")
    found = [np.zeros((len(fast), 1)) for _ in names]
    ManipulatorPairPlant(RATE, pair, **events).run(fast[:, None], slow[:, None], *found)  # type: ignore[arg-type]
    return dict(zip(names, (each[:, 0] for each in found), strict=True))


def step(samples: int = 1_000, size: float = 1e-3) -> np.ndarray:
    return np.full(samples, size)


def test_the_arm_is_what_scipy_makes_of_its_poles_and_mode() -> None:
    pole = np.prod(np.abs(POLES[:1] + POLES[3:])) * abs(POLES[1]) ** 2
    rigid = np.real(np.poly(POLES))
    omega = 2 * np.pi * 5.0
    mode = np.array([1.0, 2 * 0.05 * omega, omega**2])
    over = np.polyadd(0.7 * mode, [0.3 * omega**2])
    time = (np.arange(1_000) + 1) / RATE
    _, expected = signal.step((pole * over, np.polymul(rigid, mode)), T=np.concatenate([[0.0], time]))
    np.testing.assert_allclose(run(PAIR, 0 * step(), step())["slow"], 1e-3 * expected[1:], atol=2e-6)


def test_the_micro_manipulator_is_what_scipy_makes_of_its_loop() -> None:
    omega = 2 * np.pi * 30.0
    mode = np.array([1.0, 2 * 0.03 * omega, omega**2])
    forth = 10.0 * np.polyadd(0.9 * mode, [0.1 * omega**2])  # of the open loop: 10 / (s (0.02 s + 1)), mode beside it
    back = np.polymul([0.02, 1.0, 0.0], mode)
    time = (np.arange(1_000) + 1) / RATE
    _, expected = signal.step((forth, np.polyadd(back, forth)), T=np.concatenate([[0.0], time]))
    found = run(PAIR, step(), 0 * step())
    np.testing.assert_allclose(found["fast"], 1e-3 * expected[1:], atol=8e-6)
    np.testing.assert_allclose(found["control"][1:], 5.0 * (1e-3 - found["fast"][:-1]), atol=1e-12)


@pytest.mark.parametrize("late", [0.0, 0.011, 0.04])
def test_a_dead_time_is_one_down_to_a_part_of_a_sample(late: float) -> None:
    quick = replace(PAIR, macro=replace(MACRO, poles=(complex(-50.0),), share=0.0, dead_time=late))
    slow = run(quick, 0 * step(), step())["slow"]
    time = (np.arange(1_000) + 1) / RATE
    np.testing.assert_allclose(slow, 1e-3 * -np.expm1(-50.0 * np.maximum(time - late, 0.0)), atol=1e-9)


def test_guided_motion_filters_and_is_no_faster_than_it_may_be() -> None:
    quick = replace(PAIR, macro=replace(MACRO, poles=(complex(-1e4),), share=0.0, corner=4.0, filters=2, speed=0.02))
    slow = run(quick, 0 * step(), step(1_000, 0.05))["slow"]
    assert np.diff(slow).max() * RATE == pytest.approx(0.02, rel=1e-3)
    small = run(quick, 0 * step(), step(1_000, 1e-6))["slow"] / 1e-6
    time, omega = (np.arange(1_000) + 1) / RATE, 2 * np.pi * 4.0
    np.testing.assert_allclose(small, 1 - (1 + omega * time) * np.exp(-omega * time), atol=5e-3)


def test_the_inner_loop_saturates_and_its_process_stops() -> None:
    tight = replace(PAIR, micro=replace(MICRO, limit=1e-3, share=0.0, stop=3e-3))
    found = run(tight, step(2_000, 0.01), 0 * step(2_000))
    assert found["control"][0] == pytest.approx(0.05)
    assert np.diff(found["fast"]).max() * RATE == pytest.approx(2e-3, rel=1e-6)
    assert found["fast"][-1] == 3e-3


def test_what_happens_to_it_happens_when_it_is_told() -> None:
    found = run(PAIR, 0 * step(), 0 * step(), disturbance=1e-3, disturbed_at=2.0)
    np.testing.assert_array_equal(np.flatnonzero(found["position"])[[0]], [499])
    half = replace(PAIR, micro=replace(MICRO, limit=1e-3))
    gains = ((1.0, 2.0),)
    fast = run(half, step(500, 0.1), 0 * step(500), gains=gains)["fast"]  # type: ignore[arg-type]
    assert (fast[499] - fast[449]) / (fast[249] - fast[199]) == pytest.approx(2.0, rel=1e-4)


def test_noise_is_as_large_as_it_is_told_for_each_sensor() -> None:
    found = run(replace(PAIR, noise=(3e-6, 1e-6, 2e-6)), np.zeros(20_000), np.zeros(20_000))
    sizes = [found[name].std() for name in ("relative", "fast", "slow")]
    np.testing.assert_allclose(sizes, [3e-6, 1e-6, 2e-6], rtol=0.03)
    assert not found["position"].any()
