"""State-space models of frequency responses: ours beside pyMOR's Loewner framework and AAA, and a vector fit.

`python -m benchmarks.response_peers [--write]`, a minute, by `make peers`; prints the table of
`docs/validation/identification.md`.  Two inputs and two outputs, five resonances from 12 to 140 Hz of which two are 2.5
Hz apart, damping ratios of 0.01 to 0.05, and a lag; 392 bins from 4 to 200 Hz, errors of each bin known.  Systems of
seeds 20 to 24.  The vector fit (scikit-rf's) has a pole for each state and input: its order is that times the inputs.
"""

import logging
import time
import warnings
from collections.abc import Callable, Iterator
from importlib.util import find_spec

import numpy as np

from benchmarks.page_table import put, table
from calibration.frequency_domain import identify_response
from tests.calibration.frequency_domain.test_identify_response import at, noisy, truth

SEEDS = range(20, 25)
NOISES = (0.0, 0.01, 0.05)
"""Errors re the lines, on average."""
ORDER = 11
FREQUENCY = np.arange(4.0, 200.0, 0.5)
"""Hz."""
S = 2j * np.pi * FREQUENCY
Fitted = tuple[np.ndarray, int, bool | None]
"""Response, order, whether all poles are stable; AAA's transfer function does not tell its poles."""
Way = Callable[[np.ndarray, np.ndarray], Fitted]


def ours(response: np.ndarray, variance: np.ndarray, order: int | None = None) -> Fitted:
    """Fit by `identify_response`."""
    found = identify_response(FREQUENCY, response, variance, order=order)
    return found.response(FREQUENCY), found.order, bool(np.linalg.eigvals(found.matrices[0]).real.max() < 0)


def loewner(response: np.ndarray, _: np.ndarray) -> Fitted:
    """Fit by the Loewner framework, to the true order."""
    from pymor.reductors.loewner import LoewnerReductor

    return _of_system(LoewnerReductor(S, response).reduce(r=ORDER))


def aaa(response: np.ndarray, _: np.ndarray, support: int = 12) -> Fitted:
    """Fit by AAA with twelve support points, the least with which it finds a system without noise."""
    from pymor.reductors.aaa import PAAAReductor

    found = PAAAReductor(S, response).reduce(max_itpl=[support])
    made = np.array([np.squeeze(found.eval_tf(s)) for s in S])
    return made, support * response.shape[1], None


def vector_fit(response: np.ndarray, _: np.ndarray) -> Fitted:
    """Fit by vector fitting with the true poles' number."""
    from skrf import Frequency, Network
    from skrf.vectorFitting import VectorFitting

    fit = VectorFitting(Network(frequency=Frequency.from_f(FREQUENCY, unit="Hz"), s=response))
    fit.vector_fit(n_poles_real=1, n_poles_cmplx=(ORDER - 1) // 2, enforce_dc=False)
    rows = [
        [fit.get_model_response(i, j, FREQUENCY) for j in range(response.shape[2])] for i in range(response.shape[1])
    ]
    return np.array(rows).transpose(2, 0, 1), ORDER * response.shape[2], bool(np.real(fit.poles).max() < 0)


def _of_system(system: object) -> Fitted:
    a, b, c, d, e = (getattr(system, name) for name in ("A", "B", "C", "D", "E"))
    dense = [_dense(each) for each in (a, b, c)]
    mass, direct = (np.eye(len(dense[0])) if e is None else _dense(e)), (0.0 if d is None else _dense(d))
    response = np.array([dense[2] @ np.linalg.solve(s * mass - dense[0], dense[1]) + direct for s in S])
    poles = np.linalg.eigvals(np.linalg.solve(mass, dense[0]))
    return response, len(poles), bool(poles.real.max() < 0)


def _dense(operator: object) -> np.ndarray:
    from pymor.algorithms.to_matrix import to_matrix

    return np.asarray(to_matrix(operator, format="dense"))


WAYS: dict[str, tuple[str, Way]] = {
    "ours, order not given": ("numpy", ours),
    "ours, order given": ("numpy", lambda response, variance: ours(response, variance, ORDER)),
    "Loewner framework (pyMOR), order given": ("pymor", loewner),
    "AAA (pyMOR), twelve support points": ("pymor", aaa),
    "vector fit (scikit-rf), poles given": ("skrf", vector_fit),
}


def rows() -> Iterator[list[str]]:
    """Yield a row for each way."""
    for name, (package, way) in WAYS.items():
        if find_spec(package) is None:
            yield [name, *(["not installed"] * len(NOISES)), "", "", ""]
            continue
        cells, orders, stable, spent = [], [], [], []
        for noise in NOISES:
            off = []
            for seed in SEEDS:
                form = truth(seed=seed)
                _, response, variance = noisy(form, FREQUENCY, noise, seed)
                began = time.process_time()
                made, order, is_stable = way(response, np.maximum(variance, 1e-20 * np.abs(response) ** 2))
                spent.append(time.process_time() - began)
                off.append(np.linalg.norm(made - at(form, FREQUENCY)) / np.linalg.norm(at(form, FREQUENCY)))
                orders.append(order)
                stable.append(is_stable)
            cells.append(f"{100 * np.median(off):.2g} ({100 * max(off):.2g})")
        told = f"{min(orders)} to {max(orders)}" if min(orders) < max(orders) else f"{orders[0]}"
        yield [
            name,
            *cells,
            told,
            "-" if None in stable else f"{sum(stable)} of {len(stable)}",
            f"{np.median(spent):.2f}",
        ]


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    head = ["", *(f"errors of {100 * noise:.0f} %" for noise in NOISES), "order", "stable", "processor time, s"]
    put(table(head, list(rows())), "validation/identification.md", "response peers")


if __name__ == "__main__":
    main()
