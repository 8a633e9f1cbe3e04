"""The motion of a vibrator at its reference, as far as it is linear, and what added forces are heard as."""

import numpy as np

from firmware_sim.plants.exciter import Exciter, coil_currents, linear_response
from firmware_sim.plants.steady_kernel import clip_softly, steady_field, steady_forces
from firmware_sim.population.references import Wanted, inverse

POINTS, SAMPLES, PERIODS = 6, 256, 3
"""Frequencies of a chirp looked at; samples of a period; periods until friction repeats itself."""
ORDERS = np.arange(2, 8)
HIGHEST = 645.0
"""Hz, up to where overtones count."""


class SteadyMotion:
    """Motions at a few frequencies of the reference, all sensors at its level and in phase.

    Parameters
    ----------
    exciter : Exciter
        What of it is linear.
    wanted : Wanted
    level : float, m/s^2
    """

    def __init__(self, exciter: Exciter, wanted: Wanted, level: float) -> None:
        self._exciter, self._level = exciter, level
        points = 1 if wanted.first == wanted.last else POINTS
        self._frequency = np.geomspace(wanted.first, wanted.last, points)
        omega, coils = 2 * np.pi * self._frequency, exciter.coils
        drive = level * inverse(linear_response(exciter, self._frequency)).sum(axis=2)
        count = len(coils.factor)
        near, _ = exciter.structure.response(omega, 0, count)
        mobility = 1j * omega[:, None, None] * near[:, :count]
        currents = (coil_currents(coils, self._frequency, mobility) @ drive[:, :, None])[:, :, 0]
        forces = coils.factor * currents
        places = (near @ forces[:, :, None])[:, :, 0]
        self.displacement, self.velocity = self._in_time(places), self._in_time(1j * omega[:, None] * places)
        self.current, self.voltage = self._in_time(currents), self._in_time(coils.gain * drive)
        self.force = float(np.abs(forces).max())
        self._step = 1 / (SAMPLES * self._frequency)
        self._hear_overtones()

    def _hear_overtones(self) -> None:
        """Work out what forces and voltages at the overtones are heard as."""
        exciter = self._exciter
        self._overtones = self._frequency[:, None] * ORDERS
        every, shape = self._overtones.ravel(), self._overtones.shape
        ports, count = len(exciter.structure.inlet), len(exciter.coils.factor)
        here, heard = exciter.structure.response(2 * np.pi * every, 1, ports)
        seen = 2j * np.pi * every[:, None] * exciter.reception.sensors.response(every)
        self._heard = (seen[:, :, None] * heard).reshape(*shape, -1, ports)
        away = coil_currents(exciter.coils, every, here[:, :count, :count]) / exciter.coils.gain
        self._currents = away.reshape(*shape, count, count)

    def elements_level(self, laws: dict[int, np.ndarray]) -> float:
        """Return how loud the overtones of laws in several elements are together, 1 re the reference."""
        first = len(self._exciter.coils.factor)
        return self._loudest({first + element: self._law_forces(element, law) for element, law in laws.items()})

    def _law_forces(self, element: int, law: np.ndarray) -> np.ndarray:
        """Return the forces of a law, shape (14,), in an element over a period, shape (points, SAMPLES), N."""
        port = len(self._exciter.coils.factor) + element
        longer, velocity = (np.ascontiguousarray(each[:, :, port]) for each in (self.displacement, self.velocity))
        forces = np.zeros_like(longer)
        steady_forces(longer, velocity, law, self._step, PERIODS, forces)
        return -forces

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
        spectrum = self._spectrum(clipped - self.voltage)
        forces = self._exciter.coils.factor * (self._currents @ spectrum[..., None])[..., 0]
        return self._heard_of(self._heard[..., : forces.shape[-1]], forces)

    def _loudest(self, forces: dict[int, np.ndarray]) -> float:
        spectra = self._spectrum(np.stack(list(forces.values()), axis=-1))
        return self._heard_of(self._heard[..., list(forces)], spectra)

    def _heard_of(self, heard: np.ndarray, forces: np.ndarray) -> float:
        level = np.abs((heard @ forces[..., None])[..., 0]).max(axis=-1)
        return float(np.where(self._overtones <= HIGHEST, level, 0.0).max()) / self._level

    def _spectrum(self, periods: np.ndarray) -> np.ndarray:
        """Return amplitudes of the overtones, shape (points, orders, ports), of (points, SAMPLES, ports)."""
        spectrum: np.ndarray = 2 / SAMPLES * np.fft.rfft(periods, axis=1)[:, ORDERS]
        return spectrum

    def _in_time(self, amplitudes: np.ndarray) -> np.ndarray:
        """Return a period, shape (points, SAMPLES, ports), of complex amplitudes (points, ports)."""
        turn = np.exp(2j * np.pi * np.arange(SAMPLES) / SAMPLES)
        period: np.ndarray = (amplitudes[:, None, :] * turn[:, None]).real
        return period
