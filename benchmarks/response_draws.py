"""The order of a measured response where there is dead time, on drawn systems: `python -m benchmarks.response_draws`.

With `--write` the table goes into `docs/validation/identification.md`; a minute and a half.  One to four resonances
with damping ratios of 0.01 to 0.5, one or two inputs and outputs, dead time of 0 to 15 samples, 60 to 400 bins, errors
of 0.3 to 10 % of each bin or of their mean.  Seeds from 1000 on, which nothing was chosen on.
"""

import time
from dataclasses import dataclass

import numpy as np

from benchmarks.page_table import put, table
from calibration.frequency_domain import identify_response
from rigkit.study.summary import share_of

SEEDS = range(1000, 1100)
LATE = 16
"""Samples of dead time, fewer than."""
NEAR = 1.2
"""What is left, re the stated errors, where the order is right."""
GROUPS = {"none": (0,), "1 to 7": range(1, 8), "8 to 15": range(8, LATE)}
"""Samples of dead time."""


@dataclass(frozen=True)
class Drawn:
    """A system's response, and what was measured of it: shapes (bins,), Hz, and (bins, outputs, inputs)."""

    rate: float
    late: int
    frequency: np.ndarray
    clean: np.ndarray
    sigma: np.ndarray
    measured: np.ndarray


def draw(seed: int) -> Drawn:
    """Draw a system, its bins and their errors."""
    rng = np.random.default_rng(seed)
    bins, rate = int(rng.choice([60, 120, 190, 400])), float(rng.choice([200.0, 1000.0]))
    outputs, inputs = rng.integers(1, 3, 2)
    frequency = np.linspace(rate / 400, rate * rng.uniform(0.2, 0.48), bins)
    s, clean = 2j * np.pi * frequency, np.zeros((bins, outputs, inputs), complex)
    for _ in range(rng.integers(1, 5)):
        omega = 2 * np.pi * np.exp(rng.uniform(np.log(rate / 100), np.log(frequency[-1])))
        damping = np.exp(rng.uniform(np.log(0.01), np.log(0.5)))
        mode = omega**2 / (s**2 + 2 * damping * omega * s + omega**2)
        clean += mode[:, np.newaxis, np.newaxis] * rng.normal(size=(1, outputs, inputs))
    late = int(rng.integers(0, LATE))
    clean *= np.exp(-s * late / rate)[:, np.newaxis, np.newaxis]
    is_each, part = rng.random() < 0.5, np.exp(rng.uniform(np.log(0.003), np.log(0.1)))
    sigma = part * (np.abs(clean) if is_each else np.full(clean.shape, np.abs(clean).mean()))
    error = np.sqrt(0.5) * sigma * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
    return Drawn(rate, late, frequency, clean, sigma, clean + error)


def judged(drawn: Drawn) -> tuple[int, float, float, float]:
    """Return samples of dead time, what is left and by what the response is missed, re its errors, and seconds."""
    began = time.process_time()
    found = identify_response(drawn.frequency, drawn.measured, drawn.sigma**2, rate=drawn.rate)
    spent = time.process_time() - began
    missed = np.abs(found.response(drawn.frequency) - drawn.clean) / drawn.sigma
    return drawn.late, found.spread, float(np.sqrt(np.mean(missed**2))), spent


def main() -> None:
    """Print the table."""
    figures = np.array([judged(draw(seed)) for seed in SEEDS])
    rows = []
    for name, samples in GROUPS.items():
        left, missed, spent = figures[np.isin(figures[:, 0], samples), 1:].T
        near = share_of(int((left < NEAR).sum()), len(left))
        rows.append([
            name, near.text, near.interval,
            *(f"{value:.2f}" for value in np.percentile(missed, (50, 95))), f"{np.median(spent):.2f}",
        ])  # fmt: skip
    head = ["samples of dead time", "spread < 1.2", "95 % interval", "missed, median", "95 %", "processor time, s"]
    put(table(head, rows), "validation/identification.md", "response draws")


if __name__ == "__main__":
    main()
