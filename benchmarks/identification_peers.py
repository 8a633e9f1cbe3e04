"""Identification against other packages on the same records, in one run: time, memory, order, fit and damping.

`python -m benchmarks.identification_peers > table.md`, a quarter of an hour.  The systems of
`tests/calibration/resonant_systems.py`; every method in a process of its own, on one thread.  Packages that are not
installed (`pip install -e '.[peers]'`) are rows that say so, and so is what fails.
"""

import os
import platform
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata

import numpy as np
from scipy.optimize import linear_sum_assignment

from benchmarks.identification_methods import METHODS, PROPOSALS, RATE, Matrices
from benchmarks.identification_targets import Row, targets
from benchmarks.measured_process import Job, Outcome, measured
from calibration.fit_measures import nrmse
from calibration.state_space.model import InnovationModel
from rigkit.machine_facts import processor
from tests.calibration import resonant_systems
from tests.calibration.resonant_systems import ResonantSystem

RECORDS = 5
FRESH = 10_000
"""Samples of the record that a model is judged on; each record has one of its own."""
PACKAGES = ("ctrlsys", "sippy_unipi", "nfoursid", "control", "pysid")
SYSTEMS = {7: resonant_systems.order_7, 9: resonant_systems.order_9, 18: resonant_systems.order_18}
TITLES = {7: "one input, one output", 9: "one input, three outputs", 18: "three inputs, three outputs"}

LEFT = "ours, all left to it"
QUICK = (
    "ours",
    "ours, n4sid",
    "ours, refined",
    "SLICOT N4SID",
    "SLICOT N4SID, its own K",
    "SLICOT MOESP",
    "SIPPY N4SID",
)
CASES = (
    (7, 10_000, 20, tuple(METHODS)),
    (7, 10_000, 40, (*QUICK, "SIPPY PARSIM-K", "SIPPY PARSIM-S", "nfoursid")),
    (
        7,
        100_000,
        20,
        (*QUICK, LEFT, "SLICOT N4SID, by QR", "SIPPY PARSIM-K", "nfoursid", "python-control ERA", "pysid ARMAX"),
    ),
    (7, 100_000, 40, QUICK),
    (9, 10_000, 20, (*QUICK, "SIPPY MOESP", "SIPPY PARSIM-K", "SIPPY PARSIM-S", "nfoursid", "python-control ERA")),
    (9, 10_000, 40, QUICK),
    (18, 10_000, 20, (*QUICK, "SIPPY PARSIM-K", "SIPPY PARSIM-S", "nfoursid", "python-control ERA")),
    (18, 10_000, 40, (*QUICK, "ours, horizon left to it")),
    (18, 100_000, 20, (*QUICK, "ours, horizon left to it", LEFT, "nfoursid", "python-control ERA")),
    (7, 1_000_000, 20, ("ours", "SLICOT N4SID", "SLICOT MOESP")),
)


@dataclass(frozen=True)
class Records:
    """What is identified from, and what is judged on: arrays of shapes (records, N, m) and (records, N, p), 1."""

    drives: np.ndarray
    responses: np.ndarray
    fresh: list[tuple[np.ndarray, np.ndarray]]


def records(system: ResonantSystem, samples: int) -> Records:
    own = [system.record(samples, seed) for seed in range(RECORDS)]
    fresh = [system.record(FRESH, 1000 + seed) for seed in range(RECORDS)]
    return Records(np.array([drive for drive, _ in own]), np.array([response for _, response in own]), fresh)


def fits(matrices: Matrices, drive: np.ndarray, response: np.ndarray) -> np.ndarray:
    """Return the free run's and the one-step fit, %; NaN where there is none (not stable, no gain)."""
    low, high = drive - matrices.get("input_offset", 0.0), response - matrices.get("output_offset", 0.0)
    gain = matrices.get("K", np.zeros((len(matrices["A"]), response.shape[1])))
    system = (np.asarray(matrices[name], float) for name in "ABCD")
    model = InnovationModel(*system, gain, RATE, np.eye(response.shape[1]))
    result = np.full(2, np.nan)
    if _radius(model.A) < 1:
        result[0] = nrmse(high, model.simulate(low, model.initial_state(low, high))).mean()
    if "K" in matrices and _radius(model.A - gain @ model.C) < 1:
        result[1] = nrmse(high, model.predict(low, high, model.initial_predictor_state(low, high))).mean()
    return result


def damping_errors(matrices: Matrices, truth: InnovationModel) -> np.ndarray:
    """Return each oscillation's error, shape (modes,), %: of the poles that lie nearest to the true ones."""
    poles = np.linalg.eigvals(matrices["A"]).astype(complex)
    true, nearest = linear_sum_assignment(np.abs(truth.modes.pole[:, None] - poles))
    rates = np.log(poles[nearest]) * RATE
    damping = np.full(len(truth.modes.pole), np.nan)
    damping[true] = -rates.real / np.abs(rates)
    return (100 * (damping / truth.modes.damping - 1))[truth.modes.damping < 1 / np.sqrt(2)]


def judged(outcome: Outcome, case: tuple[int, int, int], method: str, kept: Records, truth: InnovationModel) -> Row:
    """Hold what a method found against the truth, record by record."""
    exact = {name: getattr(truth, name) for name in "ABCDK"}
    done = list(zip(outcome.models, kept.fresh, strict=False))
    short = [fits(exact, *fresh) - fits(model, *fresh) for model, fresh in done]
    damping = [damping_errors(model, truth) for model, _ in done]
    return Row(*case, method, outcome, np.array(short).reshape(-1, 2), np.array(damping))


def rows(order: int, samples: int, horizon: int, methods: tuple[str, ...]) -> Iterator[Row]:
    system = SYSTEMS[order]()
    kept = records(system, samples)
    for method in methods:
        outcome = measured(Job(method, order, horizon, kept.drives, kept.responses))
        yield judged(outcome, (order, samples, horizon), method, kept, system.model)


def table(order: int, samples: int, horizon: int, methods: tuple[str, ...]) -> list[Row]:
    """Print one case as it comes."""
    print(f"\n### Order {order}, {TITLES[order]}, {samples} samples, s = {horizon}\n")
    print(
        "| method | clock, ms | processor, ms | peak, MB (grown by) | records | free run short | one step short |",
        end="",
    )
    print(" damping, largest error by mode, % |\n|---|---|---|---|---|---|---|---|")
    made = []
    for row in rows(order, samples, horizon, methods):
        made.append(row)
        print(row.line(), flush=True)
    times = {row.method: row.outcome.cpu for row in made}
    for peer in ("SLICOT N4SID", "SLICOT MOESP", "SIPPY N4SID"):
        if np.isfinite(times.get(peer, np.nan)):
            print(f"\nProcessor time of ours over that of {peer}: {times['ours'] / times[peer]:.2f}")
    if LEFT in times:
        print(
            f"\nProcessor time with all left to it over that with order and horizon: {times[LEFT] / times['ours']:.1f}"
        )
    return made


def proposals() -> dict[tuple[int, int], list[int]]:
    """Print the orders proposed; return ours by order and horizon."""
    print(f"\n### Proposed order, 10000 samples, {RECORDS} records (how many of them)\n")
    print(f"| order, s | {' | '.join(PROPOSALS)} |\n|{'---|' * (1 + len(PROPOSALS))}")
    found = {}
    for order, make in SYSTEMS.items():
        kept = records(make(), 10_000)
        for horizon in (20, 40):
            outcomes = {name: measured(Job(name, -1, horizon, kept.drives, kept.responses)) for name in PROPOSALS}
            found[order, horizon] = outcomes["ours"].orders
            cells = [
                each.failure or ", ".join(f"{n} ({count})" for n, count in sorted(Counter(each.orders).items()))
                for each in outcomes.values()
            ]
            print(f"| {order}, s = {horizon} | {' | '.join(cells)} |", flush=True)
    return found


def main() -> None:
    print("# Identification, against other packages on the same records\n")
    machine = f"{os.cpu_count()} processors ({processor()}), Python {platform.python_version()}"
    print(f"Made by `python -m benchmarks.identification_peers`, {datetime.now(UTC):%Y-%m-%d %H:%M} UTC, on {machine},")
    print(f"numpy {np.__version__}; {', '.join(_version(name) for name in PACKAGES)}.")
    print(f"\nLoad average at the start {os.getloadavg()[0]:.1f}: the clock shows what others left of the machine, the")
    print("processor what was done. Both: the least of several runs on one record, on one thread, without imports.")
    print("Short: points of NRMSE by which the truth fits a fresh record better, mean (worst) over records;")
    print("none in the free run: not stable; one step: no gain, or a predictor that is not stable.\n")
    print("Kalman gains of SLICOT and nfoursid: from their covariances, by scipy's Riccati solver.")
    made = [row for case in CASES for row in table(*case)]
    targets(made, proposals())
    print(f"\nLoad average at the end {os.getloadavg()[0]:.1f}.")


def _radius(matrix: np.ndarray) -> float:
    return float(np.abs(np.linalg.eigvals(matrix)).max()) if np.isfinite(matrix).all() else np.inf


def _version(package: str) -> str:
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"{package} not installed"


if __name__ == "__main__":
    main()
