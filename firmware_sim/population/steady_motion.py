"""The motion of a vibrator at its reference, as far as it is linear, and what added forces are heard as.

A chirp is slow: at each of its frequencies the motion is that of a sine, and the lines of its overtone of order n are
those of the forces there times the structure's response at n times the frequency, spread over a band n times as wide.
"""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.exciter import Exciter, coil_currents, linear_response
from firmware_sim.plants.steady_kernel import clip_softly, steady_field, steady_forces
from firmware_sim.population.references import Wanted, inverse

SPACING, SAMPLES, PERIODS = 1.0, 128, 2
"""Hz between the frequencies of a chirp looked at; samples of a period; periods until friction repeats itself."""
ORDERS = np.arange(2, 8)
FINE, HIGHEST = 0.25, 645.0
"""Hz between overtones looked at, whose resonances may be sharp, and up to where they count."""


@dataclass(frozen=True)
class _Overtone:
    """What is heard of one order: shapes (lines, sensors, ports) and (lines, coils, coils).

    `share` (lines,) is where each line lies among the motions; `spread` what a line loses as they are spread.
    """

    order: int
    share: np.ndarray
    heard: np.ndarray
    currents: np.ndarray
    spread: float


class SteadyMotion:
    """Motions at the frequencies of the reference, all sensors at its level and in phase.

    Parameters
    ----------
    exciter : Exciter
        What of it is linear.
    wanted : Wanted
    level : float, m/s^2
    """

    def __init__(self, exciter: Exciter, wanted: Wanted, level: float) -> None:
        self._exciter, self._level, coils = exciter, level, exciter.coils
        points = 1 + int(np.ceil((wanted.last - wanted.first) / SPACING))
        self._frequency = np.linspace(wanted.first, wanted.last, points)
        omega, count = 2 * np.pi * self._frequency, len(exciter.coils.factor)
        drive = level * inverse(linear_response(exciter, self._frequency)).sum(axis=2)
        near, _ = exciter.structure.response(omega, 0, count)
        mobility = 1j * omega[:, None, None] * near[:, :count]
        currents = (coil_currents(coils, self._frequency, mobility) @ drive[:, :, None])[:, :, 0]
        forces = coils.factor * currents
        places = (near @ forces[:, :, None])[:, :, 0]
        self.displacement, self.velocity = self._in_time(places), self._in_time(1j * omega[:, None] * places)
        self.current, self.voltage = self._in_time(currents), self._in_time(coils.gain * drive)
        self.force = float(np.abs(forces).max())
        self._step = 1 / (SAMPLES * self._frequency)
        each = (self._overtone(int(order)) for order in ORDERS)
        self._overtones = [overtone for overtone in each if len(overtone.share)]

    def elements_level(self, laws: dict[int, np.ndarray]) -> float:
        """Return how loud the overtones of laws in several elements are together, 1 re the reference."""
        first = len(self._exciter.coils.factor)
        return self._loudest({first + element: self._law_forces(element, law) for element, law in laws.items()})

    def field_level(self, offset: float, width: float) -> float:
        """Return how loud the overtones of a field of this `width` and `offset`, m, are, 1 re the reference."""
        forces = {}
        for coil, factor in enumerate(self._exciter.coils.factor):
            row = np.array([factor, 0.0, 0.0, offset, width])
            there = np.zeros(self.displacement.shape[:2])
            steady_field(np.ascontiguousarray(self.displacement[:, :, coil]), row, there)
            forces[coil] = (there - factor) * self.current[:, :, coil]
        return self._loudest(forces)

    def clip_level(self, clip: float, sharpness: int) -> float:
        """Return how loud the overtones of an amplifier that clips at `clip` V are, 1 re the reference."""
        clipped = np.zeros_like(self.voltage)
        for motion, fainter in zip(self.voltage, clipped, strict=True):
            clip_softly(motion, clip, sharpness, fainter)
        lost = np.fft.rfft(clipped - self.voltage, axis=1) * 2 / SAMPLES
        factor, loudest = self._exciter.coils.factor, 0.0
        for overtone in self._overtones:
            voltage = _between(lost[:, overtone.order], overtone.share)
            forces = factor * (overtone.currents @ voltage[:, :, None])[:, :, 0]
            loudest = max(loudest, _level(overtone.heard[:, :, : len(factor)], forces) * overtone.spread)
        return loudest / self._level

    def _law_forces(self, element: int, law: np.ndarray) -> np.ndarray:
        """Return the forces of a law, shape (14,), in an element over a period, shape (points, SAMPLES), N."""
        port = len(self._exciter.coils.factor) + element
        longer, velocity = (np.ascontiguousarray(each[:, :, port]) for each in (self.displacement, self.velocity))
        forces = np.zeros_like(longer)
        steady_forces(longer, velocity, law, self._step, PERIODS, forces)
        return -forces

    def _loudest(self, forces: dict[int, np.ndarray]) -> float:
        ports = list(forces)
        spectra = np.fft.rfft(np.stack(list(forces.values()), axis=-1), axis=1) * 2 / SAMPLES
        each = (
            _level(overtone.heard[:, :, ports], _between(spectra[:, overtone.order], overtone.share)) * overtone.spread
            for overtone in self._overtones
        )
        return max(each, default=0.0) / self._level

    def _overtone(self, order: int) -> _Overtone:
        """Work out what forces and voltages at an overtone are heard as."""
        exciter, first, last = self._exciter, self._frequency[0], self._frequency[-1]
        lines = order * np.array([first]) if first == last else np.arange(order * first, order * last, FINE)
        lines = lines[lines <= HIGHEST]
        ports, count = len(exciter.structure.inlet), len(exciter.coils.factor)
        here, heard = exciter.structure.response(2 * np.pi * lines, 1, ports)
        seen = 2j * np.pi * lines[:, None] * exciter.reception.sensors.response(lines)
        away = coil_currents(exciter.coils, lines, here[:, :count, :count]) / exciter.coils.gain
        share = (lines / order - first) / max(last - first, 1e-9) * (len(self._frequency) - 1)
        return _Overtone(order, share, seen[:, :, None] * heard, away, 1.0 if first == last else float(order**-0.5))

    def _in_time(self, amplitudes: np.ndarray) -> np.ndarray:
        """Return a period, shape (points, SAMPLES, ports), of complex amplitudes (points, ports)."""
        turn = np.exp(2j * np.pi * np.arange(SAMPLES) / SAMPLES)
        period: np.ndarray = (amplitudes[:, None, :] * turn[:, None]).real
        return period


def _between(points: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Return what lies between points, shape (lines, ports), of (points, ports)."""
    below = np.minimum(share.astype(int), max(len(points) - 2, 0))
    above = np.minimum(below + 1, len(points) - 1)
    part = (share - below)[:, None]
    between: np.ndarray = (1 - part) * points[below] + part * points[above]
    return between


def _level(heard: np.ndarray, forces: np.ndarray) -> float:
    return float(np.abs((heard @ forces[:, :, None])[:, :, 0]).max())
