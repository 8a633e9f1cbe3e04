"""Dahl's and the LuGre model, step by step, against a fine solution of their equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from firmware_sim.plants.friction_kernel import dahl, lugre, stribeck

RATE = 44_100
STEP = 1 / RATE
TIME = (np.arange(4_410) + 0.5) * STEP
VELOCITY = 2e-3 * np.sin(2 * np.pi * 40 * TIME) + 1e-3 * np.sin(2 * np.pi * 97 * TIME)
LAW = np.array([2e6, 300.0, 20.0, 8.0, 12.0, 3e-4])


def velocity(time: float) -> float:
    """Return the velocity at any time, m/s."""
    return float(2e-3 * np.sin(2 * np.pi * 40 * time) + 1e-3 * np.sin(2 * np.pi * 97 * time))


def test_dahl_follows_its_equation() -> None:
    travel, strain, stepped = 1.5e-6, 0.0, []
    for v in VELOCITY:
        strain = dahl(strain, v, travel, STEP)
        stepped.append(strain)
    fine = solve_ivp(
        lambda t, s: velocity(t) / travel * (1 - s * np.sign(velocity(t))),
        (0, 0.1),
        [0.0],
        method="LSODA",
        t_eval=TIME + STEP / 2,
        rtol=1e-8,
        atol=1e-10,
        max_step=STEP,
    )
    np.testing.assert_allclose(stepped, fine.y[0], atol=4e-3)


def test_lugre_follows_its_equation() -> None:
    bristle, stepped = 0.0, []
    for v in VELOCITY:
        bristle, force = lugre(bristle, v, LAW, STEP)
        stepped.append(force)

    def rate(v: float, z: float) -> float:
        return v - LAW[0] * abs(v) / stribeck(v, LAW) * z

    fine = solve_ivp(
        lambda t, z: [rate(velocity(t), z[0])], (0, 0.1), [0.0], "LSODA", TIME, rtol=1e-8, atol=1e-14, max_step=STEP
    )
    damping = LAW[1] * np.exp(-((VELOCITY / LAW[5]) ** 2))
    wanted = LAW[0] * fine.y[0] + damping * [rate(v, z) for v, z in zip(VELOCITY, fine.y[0], strict=True)]
    assert np.sqrt(np.mean((stepped - wanted) ** 2)) < 0.01 * np.sqrt(np.mean(wanted**2))


def test_friction_ends_where_it_must() -> None:
    """Coulomb's force at speed; the static one where motion begins slowly; nothing from nothing."""
    strain, bristle, peak = 0.0, 0.0, 0.0
    for n in range(44_100):
        strain = dahl(strain, 1e-2, 1e-6, STEP)
        bristle, force = lugre(bristle, min(n * 1e-9, 1e-2), LAW, STEP)
        peak = max(peak, force)
    assert strain == pytest.approx(1.0)
    assert 0.9 * LAW[4] < peak <= LAW[4]
    bristle, force = lugre(bristle, 1.0, LAW, STEP)
    for _ in range(100):
        bristle, force = lugre(bristle, 1.0, LAW, STEP)
    assert force == pytest.approx(LAW[3])
    assert dahl(0.0, 0.0, 1e-6, STEP) == 0.0
    assert lugre(0.0, 0.0, LAW, STEP) == (0.0, 0.0)


@pytest.mark.parametrize("seed", range(3))
def test_friction_takes_energy_over_any_closed_path(seed: int) -> None:
    rng = np.random.default_rng(seed)
    lines = rng.integers(1, 40, 5) * 10.0
    paths = sum(rng.normal() * 1e-3 * np.sin(2 * np.pi * line * TIME) for line in lines)
    strain, bristle, spent = 0.0, 0.0, np.zeros(2)
    for turn in range(2):  # the first brings both to what repeats itself
        spent[:] = 0.0
        for v in paths:
            after = dahl(strain, v, 3e-6, STEP)
            spent[0] += 0.5 * (strain + after) * v * STEP
            strain = after
            bristle, force = lugre(bristle, v, LAW, STEP)
            spent[1] += force * v * STEP
        assert turn == 0 or (spent > 0).all()
