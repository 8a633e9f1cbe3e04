"""The simulated vibrator against real time."""

from statistics import median
from time import perf_counter

import numpy as np

from firmware_sim.plants.vibrator import VibratorPlant

RATE, SECONDS = 44_100, 5


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
