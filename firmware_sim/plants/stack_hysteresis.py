"""Hysteresis of a stack as numbers: how its expansion follows its voltage, of one over the whole range of both."""

from dataclasses import dataclass, replace

import numpy as np

from firmware_sim.plants import hysteresis_kernel as kernel

TRACE = 400
"""Steps in which the whole range is gone through to find how far a stack goes."""


@dataclass(frozen=True)
class Hysteresis:
    """One of the kernel's laws.

    Parameters
    ----------
    kind : int, of `hysteresis_kernel`
    numbers : array, shape (5,), 1; a charge's resistance in s
    threshold, weight : arrays, shape (elements,), 1
    """

    kind: int
    numbers: np.ndarray
    threshold: np.ndarray
    weight: np.ndarray

    def trace(self, voltage: np.ndarray, step: float = np.inf) -> np.ndarray:
        """Return the expansion along a voltage that begins at 0, same shape, of the range each.

        Parameters
        ----------
        voltage : array, shape (samples,), 1
        step : float, s
            From sample to sample; forever, so that a charge has settled, unless given.
        """
        elements, state, before = np.zeros(len(self.threshold)), 0.0, 0.0
        numbers = self.numbers.copy()
        if self.kind == kernel.MAXWELL_SLIP:
            numbers[kernel.RESISTANCE] /= step
        found = np.empty(len(voltage))
        for n, now in enumerate(np.asarray(voltage, float)):
            found[n] = numbers[kernel.SLOPE] * now
            if self.kind == kernel.BOUC_WEN:
                state = kernel.bouc_wen(before, now, state, numbers)
                found[n] -= state
            elif self.kind == kernel.PLAYS:
                found[n] += kernel.plays(now, elements, self.threshold, self.weight)
            elif self.kind == kernel.MAXWELL_SLIP:
                state = kernel.charge(before, now, state, elements, self.threshold, self.weight, numbers)
                found[n] = numbers[kernel.SLOPE] * state
            before = now
        return found


def straight() -> Hysteresis:
    """Return none: a stack whose charge is controlled."""
    return Hysteresis(kernel.LINEAR, np.array([0.0, 0.0, 0.0, 0.0, 1.0]), np.zeros(1), np.zeros(1))


def bouc_wen(change: float, share: float, reach: float, power: float) -> Hysteresis:
    """Return that of Bouc and Wen.

    Parameters
    ----------
    change : float, 1
        The slope is between 1 - `change` and 1 + `change` times their mean.
    share : float, 1, 0.5 to 1
        beta / (beta + gamma).
    reach : float, 1
        Part of the voltage's range in which it is built up, nearly.
    power : float, 1, >= 1
        n.
    """
    growth = change / (share * (1.0 + change))
    both = growth / (growth * reach) ** power
    numbers = np.array([growth, share * both, (1.0 - share) * both, power, 1.0])
    return _of_one(Hysteresis(kernel.BOUC_WEN, numbers, np.zeros(1), np.zeros(1)))


def prandtl_ishlinskii(change: float, threshold: np.ndarray, density: np.ndarray) -> Hysteresis:
    """Return a sum of plays.

    Parameters
    ----------
    change : float, 1
        The slope is between 1 - `change` and 1 + `change` times their mean.
    threshold : array, shape (elements,), 1
        Of each play, half its width; of the voltage's range.
    density : array, shape (elements,), 1
        How much each play weighs beside the others.
    """
    most = 2.0 * change / (1.0 + change)
    numbers = np.array([0.0, 0.0, 0.0, 0.0, 1.0 - most])
    return _of_one(Hysteresis(kernel.PLAYS, numbers, threshold, most * density / density.sum()))


def maxwell_slip(change: float, reach: np.ndarray, density: np.ndarray, delay: float) -> Hysteresis:
    """Return that of a charge with elasto-slide elements, which is also late.

    Parameters
    ----------
    change : float, 1
        The slope of charge over voltage is between 1 - `change` and 1 + `change` times their mean.
    reach : array, shape (elements,), 1
        Of the range of the charge: where each element begins to slide.
    density : array, shape (elements,), 1
        How stiff each element is beside the others.
    delay : float, s
        Time constant of the charge while all slide.
    """
    stiff = 2.0 * change / (1.0 - change) * density / density.sum()
    numbers = np.array([1.0, delay, 0.0, 0.0, 1.0])
    return _of_one(Hysteresis(kernel.MAXWELL_SLIP, numbers, stiff * reach, stiff))


def _of_one(made: Hysteresis) -> Hysteresis:
    """Scale it so that a voltage up and down over its whole range expands it by one between both ends."""
    up = np.linspace(0.0, 1.0, TRACE)
    along = made.trace(np.concatenate([up, up[::-1], up]))
    scale = 1.0 / (along[-1] - along[2 * TRACE - 1])
    numbers, weight = made.numbers.copy(), made.weight
    numbers[kernel.SLOPE] *= scale
    if made.kind == kernel.BOUC_WEN:
        power = numbers[kernel.POWER]
        numbers[kernel.GROWTH] *= scale
        numbers[[kernel.BETA, kernel.GAMMA]] *= scale ** (1.0 - power)
    if made.kind == kernel.PLAYS:
        weight = weight * scale
    return replace(made, numbers=numbers, weight=weight)
