"""Force control a sample a call, and its outer problem solved in closed form beside scipy's Riccati solver."""

from statistics import median
from time import perf_counter

import numpy as np
from scipy.linalg import solve_discrete_are

from rigkit.compiled import njit
from stagectl.robot.feed_config import ForceFeed
from stagectl.robot.milling import force_gain_kernel as outer
from stagectl.robot.milling.feed_force import FeedForce
from stagectl.robot.milling.nominal_velocity import nominal_velocity
from tests.stagectl.robot.milling.test_force_gain import by_riccati, outer_of, process

SAMPLE = 4e-3
"""s there are."""


def _settings() -> np.record:
    return outer_of(75e3, 1 / 0.018, 0.05**-2, 0.0, 1.0, SAMPLE)


@njit
def _many(kappas, settings):  # type: ignore[no-untyped-def] # noqa: ANN001, ANN202
    total = 0.0
    for kappa in kappas:
        total += outer.gains(kappa, 1.1, settings)[1]
    return total


def _closed_form(kappas: np.ndarray) -> float:
    start = perf_counter()
    _many(kappas, _settings())
    return (perf_counter() - start) / len(kappas)


def _riccati(kappas: np.ndarray) -> float:
    """Return the seconds of scipy's solver alone, on matrices that are made already."""
    settings = _settings()
    made = [(*process(kappa, 1.1, settings), np.diag([0.0, 1.0, settings.integral]),
             np.array([[outer.control_weight(kappa, 1.1, settings)]])) for kappa in kappas]  # fmt: skip
    start = perf_counter()
    for each in made:
        solve_discrete_are(*each)
    return (perf_counter() - start) / len(made)


def test_a_gain_solved_anew(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print what a gain costs, in closed form and by scipy, the quickest of some rounds, and how far they are apart."""
    rng, settings = np.random.default_rng(1), _settings()
    kappas = 10 ** rng.uniform(-4, -2.3, 20_000)
    _closed_form(kappas[:10])
    ours, theirs = (min(f(kappas[:n]) for _ in range(9)) for f, n in ((_closed_form, 2_000), (_riccati, 20)))
    apart = 0.0
    for kappa in kappas[:200]:
        wanted = by_riccati(kappa, 1.1, settings)[0]
        found = np.array(outer.gains(kappa, 1.1, settings)) * [1.0, 1.0, -1.0]
        apart = max(apart, float(np.abs(found / wanted - 1.0).max()))
    print(f"\nclosed form {1e6 * ours:.2f} us, {100 * ours / SAMPLE:.3f} % of 4 ms; scipy {1e6 * theirs:.0f} us "
          f"({theirs / ours:.0f} times); apart by {apart:.1g}")  # fmt: skip
    assert apart < 1e-6
    benchmark(outer.gains, 4e-4, 1.1, settings)


def test_a_sample_of_force_control(benchmark) -> None:  # type: ignore[no-untyped-def] # noqa: ANN001
    """Print what a call of one sample costs, observer, estimates, both loops and watch included."""
    block = FeedForce(ForceFeed(), nominal_velocity(250.0))
    block.prepare(250.0, 1)
    rng = np.random.default_rng(1)
    inputs = [np.full((1, 1), 0.004), np.array([[8.0, 4.0]]), np.ones((1, 1)), np.ones((1, 1))]
    outputs = [np.zeros((1, port.width)) for port in block.outputs]
    for _ in range(200):  # into force control
        inputs[1][:] = [8.94, 4.47] + 0.15 * rng.standard_normal(2)
        block.process(*inputs, *outputs)
    assert outputs[-1][0, 0] == 3.0
    took = []
    for _ in range(5_000):
        start = perf_counter()
        block.process(*inputs, *outputs)
        took.append(perf_counter() - start)
    print(f"\na sample {1e6 * median(took):.2f} us, {100 * median(took) / SAMPLE:.3f} % of 4 ms")
    benchmark(block.process, *inputs, *outputs)
