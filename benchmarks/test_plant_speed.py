"""The simulated vibrator and the simulated stage against real time."""

from statistics import median
from time import perf_counter, process_time

import numpy as np

from firmware_sim.plants.piezo_stage import PiezoStagePlant
from firmware_sim.plants.vibrator import VibratorPlant
from firmware_sim.population import Vibrator

RATE, SECONDS = 44_100, 5
DRAWN = 53
"""Seed of a shell with two coils, two sensors and 34 modes, and five of the six mechanisms of distortion."""


def test_the_plant_against_real_time(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print how many times faster than real time it runs."""
    drive = np.random.default_rng(1).standard_normal((SECONDS * RATE, 2))
    response, plant, times = np.zeros_like(drive), VibratorPlant(RATE), []
    plant.run(drive[:1000], response[:1000])
    for _ in range(7):
        start = perf_counter()
        plant.run(drive, response)
        times.append(perf_counter() - start)
    print(f"\nplant: {SECONDS / median(times):.0f} x real time")
    benchmark.pedantic(plant.run, (drive, response), rounds=5)


def test_a_drawn_vibrator_against_real_time(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print how many times faster than real time two coils, two sensors and 34 modes run."""
    plant, times = Vibrator(seed=DRAWN, family="shell"), []
    plant.prepare(float(RATE), SECONDS * RATE)
    drive = np.random.default_rng(1).standard_normal((SECONDS * RATE, 2))
    response = np.zeros_like(drive)
    for _ in range(7):
        start = process_time()
        plant.process(drive, response)
        times.append(process_time() - start)
    print(f"\ndrawn vibrator: {SECONDS / median(times):.0f} x real time, by processor time")
    assert SECONDS / median(times) > 20
    benchmark.pedantic(plant.process, (drive, response), rounds=3)


def test_the_stage_against_real_time(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print what a sample of three axes costs in long frames, and what a call of one sample does."""
    plant, times = PiezoStagePlant(10_000.0), []
    for frames, calls in ((200_000, 1), (1, 20_000)):
        signals = np.zeros((6, frames, 3))
        plant.run(*signals)
        rounds = []
        for _ in range(5):
            start = perf_counter()
            for _ in range(calls):
                plant.run(*signals)
            rounds.append((perf_counter() - start) / (frames * calls))
        times.append(1e9 * median(rounds))
    print(f"\nstage: {times[0]:.0f} ns a sample in long frames, {times[1]:.0f} ns a call of one")
    benchmark.pedantic(plant.run, tuple(signals), rounds=5)
