"""How far a loop is from instability: maximum sensitivity, gain, phase and delay margins."""

from dataclasses import dataclass

import numpy as np

from stagectl.stage.state_space import StateSpace

LOWEST = 1e-5
"""Of the rate: lowest frequency that is looked at."""
COARSE = 600
"""Frequencies from there to half the rate."""
AROUND_A_POLE = np.concatenate([-np.geomspace(20, 0.02, 25), [0.0], np.geomspace(0.02, 20, 25)])
"""Of its half width: frequencies around a pole's own."""


@dataclass(frozen=True)
class Robustness:
    """The figures of a loop with the extra delay; stability and Ms are the worse of those with it and without.

    Parameters
    ----------
    stable : bool
    max_sensitivity : float, 1
        Ms = max |1 / (1 + L)|; infinite where the loop is not stable.
    at : float, Hz
        Where it is reached.
    gain_margins : tuple of two floats, 1
        Factors on the loop's gain, below and above one, at which it becomes unstable; 0 and infinite for never.
    phase_margin : float, degrees
        Least over all crossings of gain one; infinite where there is none.
    delay_margin : float, s
        Least delay that makes it unstable; infinite for never.
    crossover : float, Hz
        Highest frequency at which the loop's gain is one; 0 where there is none.
    """

    stable: bool
    max_sensitivity: float
    at: float
    gain_margins: tuple[float, float]
    phase_margin: float
    delay_margin: float
    crossover: float

    def __str__(self) -> str:
        """Say it in one line."""
        low, high = self.gain_margins
        return (
            f"Ms {self.max_sensitivity:.2f} at {self.at:.0f} Hz, gain margins {low:.2f} and {high:.2f}, phase margin "
            f"{self.phase_margin:.0f} degrees, delay margin {1e6 * self.delay_margin:.0f} us, crossover "
            f"{self.crossover:.0f} Hz"
        )


def robustness(plant: StateSpace, controller: StateSpace, rate: float, delay: int = 0) -> Robustness:
    """Return the figures of the loop of `plant` and `controller` under negative feedback.

    Parameters
    ----------
    plant, controller : StateSpace
        The controller from the error to the plant's input.
    rate : float, samples/s
    delay : int, samples
        Extra delay that the figures are for.
    """
    loop = controller.then(plant)
    stable = all(is_stable(loop.delayed(late)) for late in {0, delay})
    frequency = frequencies([plant, loop.closed()], rate)
    gain = controller.response(frequency, rate) * plant.response(frequency, rate)
    late = np.exp(-2j * np.pi * frequency * delay / rate)
    sensitivity = np.maximum(np.abs(1.0 / (1.0 + gain)), np.abs(1.0 / (1.0 + gain * late)))
    worst = int(np.argmax(sensitivity))
    phase, time, crossover = _crossings(frequency, gain * late)
    return Robustness(
        stable,
        float(sensitivity[worst]) if stable else float("inf"),
        float(frequency[worst]),
        _gain_margins(gain * late),
        phase,
        time,
        crossover,
    )


def frequencies(systems: list[StateSpace], rate: float) -> np.ndarray:
    """Return frequencies from near 0 to half the rate that miss no resonance of `systems`: shape (bins,), Hz."""
    poles = np.concatenate([np.linalg.eigvals(system.A) for system in systems]).astype(complex)
    poles = poles[(poles.imag > 0) & (np.abs(poles) > 0)]
    natural = np.log(poles) * rate / (2 * np.pi)
    width = np.maximum(np.abs(natural.real), LOWEST * rate)
    near = natural.imag[:, None] + width[:, None] * AROUND_A_POLE
    every = np.concatenate([np.geomspace(LOWEST * rate, rate / 2, COARSE), near.ravel()])
    return np.unique(every[(every >= LOWEST * rate) & (every <= rate / 2)])


def is_stable(loop: StateSpace) -> bool:
    """Whether negative unit feedback around `loop` is stable."""
    return bool(np.abs(np.linalg.eigvals(loop.closed().A)).max(initial=0.0) < 1.0)


def _crossings(frequency: np.ndarray, gain: np.ndarray) -> tuple[float, float, float]:
    """Return phase margin (degrees), delay margin (s) and crossover (Hz)."""
    level = np.log(np.abs(gain))
    before = np.flatnonzero(np.signbit(level[1:]) != np.signbit(level[:-1]))
    if len(before) == 0:
        return float("inf"), float("inf"), 0.0
    share = level[before] / (level[before] - level[before + 1])
    at = frequency[before] + share * (frequency[before + 1] - frequency[before])
    angle = np.angle(-(gain[before] + share * (gain[before + 1] - gain[before])))
    lag = np.mod(angle, 2 * np.pi)  # what may be lost before the loop meets -1
    return float(np.degrees(np.abs(angle).min())), float((lag / (2 * np.pi * at)).min()), float(at.max())


def _gain_margins(gain: np.ndarray) -> tuple[float, float]:
    crossing = np.flatnonzero(np.signbit(gain.imag[1:]) != np.signbit(gain.imag[:-1]))
    share = gain.imag[crossing] / (gain.imag[crossing] - gain.imag[crossing + 1])
    real = gain.real[crossing] + share * (gain.real[crossing + 1] - gain.real[crossing])
    real = np.append(real, gain.real[-1])
    factors = -1.0 / real[real < 0]
    return float(factors[factors < 1].max(initial=0.0)), float(factors[factors > 1].min(initial=np.inf))
