"""A discrete linear system, alone or in a loop with an observer, sample by sample."""

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def run_loop(
    system: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    gains: tuple[np.ndarray, np.ndarray],
    added: np.ndarray,
    noise: np.ndarray,
    given: np.ndarray,
    measured: np.ndarray,
) -> None:
    """Fill `given` (samples, inputs) and `measured` (samples, outputs), any unit.

    `system` is A, B, C, D of x' = A x + B u, y = C x + D u; `gains` F (inputs, states) and L (states, outputs) of
    u = r - F z, z' = A z + B u + L (y - C z - D u), all zero where there is no loop; `added` (samples, inputs) is r,
    `noise` (samples, outputs) what comes to y.
    """
    a, b, c, d = system
    feedback, observer = gains
    states, inputs, outputs = a.shape[0], b.shape[1], c.shape[0]
    x, z, innovation = np.zeros(states), np.zeros(states), np.zeros(outputs)
    new_x, new_z = np.zeros(states), np.zeros(states)
    for n in range(added.shape[0]):
        for i in range(inputs):
            given[n, i] = added[n, i]
            for j in range(states):
                given[n, i] -= feedback[i, j] * z[j]
        for o in range(outputs):
            measured[n, o] = noise[n, o]
            innovation[o] = noise[n, o]
            for j in range(states):
                measured[n, o] += c[o, j] * x[j]
                innovation[o] += c[o, j] * (x[j] - z[j])
            for i in range(inputs):
                measured[n, o] += d[o, i] * given[n, i]
        for j in range(states):
            new_x[j] = new_z[j] = 0.0
            for k in range(states):
                new_x[j] += a[j, k] * x[k]
                new_z[j] += a[j, k] * z[k]
            for i in range(inputs):
                pushed = b[j, i] * given[n, i]
                new_x[j] += pushed
                new_z[j] += pushed
            for o in range(outputs):
                new_z[j] += observer[j, o] * innovation[o]
        for j in range(states):
            x[j], z[j] = flushed(new_x[j]), flushed(new_z[j])
