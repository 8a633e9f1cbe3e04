"""The tables by which `exciter_kernel` steps a structure, from its poles; again whenever they have moved."""

import cmath

import numpy as np

from rigkit.compiled import njit


@njit(cache=True, nogil=True)
def tabulate(
    structure: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    factor: np.ndarray,
    coils: int,
    step: float,
    turn: np.ndarray,
    push: np.ndarray,
    look: np.ndarray,
    direct: np.ndarray,
) -> None:
    """Fill `turn` (2, room), `push` (forces, 2 room), `look` (2 forces + sensors, 2 room), `direct` (sensors, forces).

    `structure` is a `Structure`'s poles, inlet, outlet and sensors; there is room for more modes than it has, which
    stay zero.  `factor` (modes,) 1 is how far its poles have moved; `coils` how many of its forces are coils'; `step`
    in s.  All is seen at mid-step, accelerations (`direct`, 1/kg) with what the forces of the step do until then.
    """
    poles, inlet, outlet, sensors = structure
    forces, count, room = inlet.shape[0], sensors.shape[0], turn.shape[1]
    elements = forces - coils
    direct[:, :] = 0.0
    for m in range(poles.shape[0]):
        pole = poles[m] * factor[m]
        whole, half = cmath.exp(pole * step), cmath.exp(0.5 * pole * step)
        held, held_half = (whole - 1.0) / pole, (half - 1.0) / pole
        turn[0, m], turn[1, m] = whole.real, whole.imag
        for k in range(forces):
            pushed, place = inlet[k, m] / factor[m], outlet[k, m] * half
            push[k, m], push[k, room + m] = (held * pushed).real, (held * pushed).imag
            at = k if k < coils else coils + k
            rate = at + (coils if k < coils else elements)
            look[at, m], look[at, room + m] = place.real, -place.imag
            look[rate, m], look[rate, room + m] = (pole * place).real, -(pole * place).imag
            for s in range(count):
                direct[s, k] += (sensors[s, m] * pole * (pole * held_half + 1.0) * pushed).real
        for s in range(count):
            seen = sensors[s, m] * pole * pole * half
            look[2 * forces + s, m], look[2 * forces + s, room + m] = seen.real, -seen.imag
