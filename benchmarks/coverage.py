"""How often the truth lies within 1.96 standard errors of what is identified: 95 % where these are right.

`python -m benchmarks.coverage [FIRST] [--write]`, half an hour; a table of `docs/validation/identification.md`, of
seeds from FIRST on, default 5000.
Each record is of a system of its own: two resonances of 2 to 35 % of the rate, damping ratios of 0.01 to 0.1, random
shares and gains, noise 20 dB below the response, white on the output or the innovations of a process that random
forces shake as well; inputs are white, or white about a PI controller of half the gain that small gain allows,
which answers a sample later.
"""

import warnings
from collections.abc import Iterator
from itertools import product

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, table, words
from calibration import subspace
from calibration.prediction_error import refine
from calibration.state_space import InnovationModel

SIZES = {1_000: 300, 10_000: 300, 100_000: 60}
"""Records of each length."""
FIRST = 5000
"""Seed."""
KINDS = ("subspace", "refined")
FIGURES = ("frequency", "damping", "magnitude", "phase", "free run")
FREQUENCY = np.linspace(0.01, 0.48, 48)
FRESH = 200
"""Samples of a free run."""
SURE = 1.96
NOISE = 0.01
"""Power re the response's."""


def drawn(seed: int, coloured: bool) -> InnovationModel:
    """Return a system with its noise."""
    rng = np.random.default_rng([seed, coloured])
    first = rng.uniform(0.02, 0.3)
    natural, damping = np.array([first, first + rng.uniform(0.03, 0.05)]), 10 ** rng.uniform(-2, -1, 2)
    turns = np.exp(2 * np.pi * natural * (1j * np.sqrt(1 - damping**2) - damping))
    a = block_diag(*([[turn.real, turn.imag], [-turn.imag, turn.real]] for turn in turns))
    b, c = rng.standard_normal((4, 1)), np.kron(rng.choice([-1.0, 1.0], 2) * rng.uniform(0.5, 2.0, 2), [1.0, 0.0])[None]
    plain = InnovationModel(a, b, c, np.zeros((1, 1)), np.zeros((4, 1)), 1.0, np.ones((1, 1)))
    power = float(np.sum(impulse(plain) ** 2)) * NOISE
    if not coloured:
        return InnovationModel(a, b, c, np.zeros((1, 1)), np.zeros((4, 1)), 1.0, np.full((1, 1), power))
    force = rng.standard_normal((4, 1))
    shaken = InnovationModel(a, force, c, np.zeros((1, 1)), np.zeros((4, 1)), 1.0, np.ones((1, 1)))
    force *= np.sqrt(0.5 * power / np.sum(impulse(shaken) ** 2))
    white = np.full((1, 1), 0.5 * power)
    spread = solve_discrete_are(a.T, c.T, force @ force.T, white)
    innovation = c @ spread @ c.T + white
    return InnovationModel(a, b, c, np.zeros((1, 1)), a @ spread @ c.T / innovation, 1.0, innovation)


def impulse(model: InnovationModel) -> np.ndarray:
    """Return the response to a pulse, shape (samples,), until it has died out."""
    drive = np.zeros((4_000, 1))
    drive[0] = 1.0
    return model.simulate(drive)[:, 0]


def record(truth: InnovationModel, samples: int, seed: int, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return drive and response, shapes (samples,)."""
    rng = np.random.default_rng([seed, samples, 1])
    asked, heard = rng.standard_normal((2, samples)) * [[1.0], [truth.innovation[0, 0] ** 0.5]]
    gain = 0.5 / np.abs(truth.frequency_response(np.linspace(0, 0.5, 4_000))).max() if closed else 0.0
    slow = 0.02 * gain * np.sign(truth.frequency_response(np.zeros(1))[0, 0, 0].real)
    a, b, c, k = truth.A, truth.B, truth.C, truth.K
    none, one = np.zeros((1, 1)), np.ones((1, 1))  # states: plant, integral, the output a sample ago
    loop = InnovationModel(
        np.block([[a, -slow * b, -gain * b], [c, one, none], [c, none, none]]),
        np.block([[b, k], [none, one], [none, one]]),
        np.block([[np.zeros((1, 4)), -slow * one, -gain * one], [c, none, none]]),
        np.eye(2),
        np.zeros((6, 2)),
        1.0,
        np.eye(2),
    )
    if closed and np.abs(loop.poles).max() >= 1:
        raise ValueError(f"the loop of seed {seed} is not stable")
    drive, response = loop.simulate(np.column_stack([asked, heard])).T
    return drive, response


def within(seed: int, samples: int, coloured: bool, closed: bool) -> dict[str, list[float]]:
    """Return, by kind, the share of each of `FIGURES` that is within its bound."""
    truth = drawn(seed, coloured)
    drive, response = record(truth, samples, seed, closed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = subspace.identify(drive, response, 1.0, order=4)
    shares = {"subspace": list(_shares(found.core, truth, found))}
    has_direct = found.resampling.terms.direct  # not in a loop that may close at once
    low, high = drive - found.input_offset, response - found.output_offset
    refined = refine(found.core, low, high, direct=has_direct)
    shares["refined"] = list(_shares(refined.model, truth, refined))
    return shares


def _shares(model: InnovationModel, truth: InnovationModel, found: object) -> Iterator[float]:
    """Yield the shares of `FIGURES`."""
    errors = found.pole_errors if isinstance(found, subspace.Identified) else found.errors
    for name in ("frequency", "damping"):
        off, sure = getattr(model.modes, name) - getattr(truth.modes, name), getattr(errors, name)
        yield float(np.mean(np.abs(off) < SURE * sure))
    if isinstance(found, subspace.Identified):
        of_response, of_run = found.response_errors(FREQUENCY), found.simulation_errors
    else:
        moves = found.sensitivities
        of_response, of_run = moves.response_errors(model, FREQUENCY), lambda u: moves.simulation_errors(model, u)
    ratio, right = (each.frequency_response(FREQUENCY)[:, 0, 0] for each in (model, truth))
    yield float(np.mean(np.abs(np.abs(ratio) - np.abs(right)) < SURE * of_response.magnitude[:, 0, 0]))
    yield float(np.mean(np.abs(np.angle(ratio / right)) < SURE * of_response.phase[:, 0, 0]))
    drive = np.random.default_rng(1).standard_normal((FRESH, 1))
    off = np.abs(model.simulate(drive) - truth.simulate(drive))
    yield float(np.mean(off[10:] < SURE * of_run(drive)[10:]))


def main() -> None:
    """Print the table."""
    first, rows = int((words() or [str(FIRST)])[0]), []
    for closed, coloured, (samples, count) in product((False, True), (False, True), SIZES.items()):
        found = list(over_seeds(within, range(first, first + count), samples=samples, coloured=coloured, closed=closed))
        for kind in KINDS:
            means = 100 * np.mean([each[kind] for each in found], axis=0)
            what = ("closed" if closed else "open", "coloured" if coloured else "white", samples, count, kind)
            rows.append([*what, *(f"{mean:.1f}" for mean in means)])
            print(*rows[-1], flush=True)
    put(
        table(["loop", "noise", "samples", "records", "model", *FIGURES], rows),
        "validation/identification.md",
        "coverage",
    )


if __name__ == "__main__":
    main()
