"""Random linear systems of three kinds of structure, order 1 to 40: modes, a random similarity, a cascade."""

from collections.abc import Callable

import numpy as np
from scipy.linalg import block_diag

from firmware_sim.population.mechanics import log_uniform
from firmware_sim.population.streams import Streams

Matrices = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""A, B, C and D."""
BAND = (0.002, 0.4)
"""1, of the rate: where poles are."""
DAMPING = (0.003, 0.5)
"""1, ratios."""
RADIUS = (0.3, 0.995)
"""1, of poles that are drawn in the unit circle."""
DIRECT = 0.4
"""1: systems with a direct term."""


def modes(streams: Streams, order: int, inputs: int, outputs: int) -> Matrices:
    """Draw a structure that resonates: pairs of poles each with its own shape, and a real one if the order is odd."""
    rng = streams("poles")
    pairs = order // 2
    frequency, damping = log_uniform(rng, *BAND, pairs), log_uniform(rng, *DAMPING, pairs)
    poles = np.exp(2 * np.pi * frequency * (-damping + 1j * np.sqrt(1 - damping**2)))
    blocks = [np.array([[p.real, p.imag], [-p.imag, p.real]]) for p in poles]
    blocks += [np.array([[np.exp(-2 * np.pi * log_uniform(rng, *BAND))]])] * (order % 2)
    dynamics = block_diag(*blocks)
    shapes = streams("shapes")
    inlet, outlet = shapes.standard_normal((order, inputs)), shapes.standard_normal((outputs, order))
    slow = np.concatenate([np.full(len(block), 1 - np.abs(np.linalg.eigvals(block)[0])) for block in blocks])
    return dynamics, inlet * np.sqrt(slow)[:, None], outlet * np.sqrt(slow), _direct(streams, inputs, outputs)


def similar(streams: Streams, order: int, inputs: int, outputs: int) -> Matrices:
    """Draw poles all over the unit circle, in coordinates of their own: nothing is sparse."""
    rng = streams("poles")
    pairs = int(rng.integers(order // 2 + 1))
    radius, angle = rng.uniform(*RADIUS, pairs), rng.uniform(0, np.pi, pairs)
    poles = radius * np.exp(1j * angle)
    blocks = [np.array([[p.real, p.imag], [-p.imag, p.real]]) for p in poles]
    blocks += [np.array([[p]]) for p in rng.uniform(-0.9, RADIUS[1], order - 2 * pairs)]
    turn, _ = np.linalg.qr(streams("coordinates").standard_normal((order, order)))
    stretch = log_uniform(streams("stretch"), 0.3, 3.0, order)
    change = turn * stretch
    dynamics = change @ block_diag(*blocks) @ np.linalg.inv(change)
    shapes = streams("shapes")
    inlet, outlet = shapes.standard_normal((order, inputs)), shapes.standard_normal((outputs, order))
    return dynamics, inlet, outlet, _direct(streams, inputs, outputs)


def cascade(streams: Streams, order: int, inputs: int, outputs: int) -> Matrices:
    """Draw lags one after the other, each fed by the one before and a little by the one behind, as tanks are."""
    rng = streams("lags")
    pace = log_uniform(rng, 0.005, 0.6, order)
    back = pace[:-1] * rng.uniform(0.0, 0.2, order - 1)
    dynamics = np.diag(1 - pace) + np.diag(pace[1:], -1) + np.diag(back, 1) - np.diag([0.0, *back])
    places = streams("places")
    inlet, outlet = np.zeros((order, inputs)), np.zeros((outputs, order))
    inlet[places.integers(0, order, inputs), np.arange(inputs)] = places.uniform(0.5, 2.0, inputs)
    inlet[0, 0] = 1.0
    outlet[np.arange(outputs), places.integers(0, order, outputs)] = places.uniform(0.5, 2.0, outputs)
    outlet[0, -1] = 1.0
    return dynamics, inlet, outlet, np.zeros((outputs, inputs))


def _direct(streams: Streams, inputs: int, outputs: int) -> np.ndarray:
    rng = streams("direct term")
    has_one: bool = bool(rng.uniform() < DIRECT)
    direct: np.ndarray = has_one * 0.3 * rng.standard_normal((outputs, inputs))
    return direct


SYSTEMS: dict[str, Callable[[Streams, int, int, int], Matrices]] = {
    "modes": modes,
    "similar": similar,
    "cascade": cascade,
}


def with_integrators(system: Matrices, count: int) -> Matrices:
    """Return a system behind whose first outputs integrators stand: what is measured there is their sum."""
    a, b, c, d = system
    order = len(a)
    whole = block_diag(a, np.eye(count))
    whole[order:, :order] = c[:count]
    outlet = np.concatenate([c, np.zeros((len(c), count))], axis=1)
    outlet[:count] = 0.0
    outlet[np.arange(count), order + np.arange(count)] = 1.0
    direct = d.copy()
    direct[:count] = 0.0
    return whole, np.concatenate([b, d[:count]]), outlet, direct


def with_unstable(system: Matrices, rng: np.random.Generator) -> Matrices:
    """Return a system with one more pole outside the unit circle, which all inputs move and all outputs see."""
    a, b, c, d = system
    pole = 1 + log_uniform(rng, 0.003, 0.1)
    inlet, outlet = rng.uniform(0.5, 1.5, (1, b.shape[1])), rng.uniform(0.5, 1.5, (len(c), 1))
    scale = np.sqrt(pole - 1)
    return block_diag(a, [[pole]]), np.concatenate([b, scale * inlet]), np.concatenate([c, scale * outlet], axis=1), d
