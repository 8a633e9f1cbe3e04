"""Any electrodynamic vibrator: coils that shake a structure with nonlinear elements in it, and sensors that hear it."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.exciter_kernel import AMPLIFIER, COLUMNS, LUGRE, run_exciter
from firmware_sim.plants.mode_drift import Drift, ModeDrift
from firmware_sim.plants.options import refuse_rate
from firmware_sim.plants.reception import BLOCK, Receiver, Reception, in_blocks
from firmware_sim.plants.structure import Structure
from firmware_sim.plants.structure_kernel import tabulate

LANES = 8
"""There is room for a multiple of so many modes: what is left over by vectors takes as long as they do."""


@dataclass(frozen=True)
class Coils:
    """Coils in their magnets, each behind its channel of one kind of amplifier.

    Parameters
    ----------
    factor : array, shape (coils,), N/A
        The force factor BL at rest.
    resistance, inductance : arrays, shape (coils,), ohm and H
        Amplifier and cable included.
    offset, width : arrays, shape (coils,), m
        How far the rest is off the field's middle, and where BL has fallen to 1/e of the middle's; 0: it never falls.
    gain : float, V/V
        Of the amplifier.
    clip : float, V
        Where its output saturates; 0: nowhere.
    sharpness : int, 1, 2 or 4
        How suddenly.
    """

    factor: np.ndarray
    resistance: np.ndarray
    inductance: np.ndarray
    offset: np.ndarray
    width: np.ndarray
    gain: float
    clip: float
    sharpness: int


@dataclass(frozen=True)
class Exciter:
    """A vibrator, whole.

    Parameters
    ----------
    structure : Structure
        Its forces are the coils' and then the elements'; an element's is against its elongation.
    coils : Coils
    elements : array, shape (elements, 14)
        The nonlinear laws; the columns are those of `exciter_kernel`.
    reception : Reception
    drift : Drift
    """

    structure: Structure
    coils: Coils
    elements: np.ndarray
    reception: Reception
    drift: Drift


class ExciterPlant:
    """An `Exciter` sample by sample, from rest.

    It does not model: rotation and sideways motion of coils, heat in them, inductance that depends on displacement and
    current, an amplifier's own noise, clocks that drift, wear.

    Parameters
    ----------
    exciter : Exciter
    rate : float, samples/s, 8000 to 1e6
    seed : int
        Of its noise and of what wanders.
    """

    def __init__(self, exciter: Exciter, rate: float, seed: int) -> None:
        refuse_rate(rate, 8_000, 1e6, "a simulated vibrator")
        self._exciter, self._rate = exciter, rate
        structure, modes = exciter.structure, len(exciter.structure.poles)
        forces, sensors = len(structure.inlet), len(structure.sensors)
        room = -(-modes // LANES) * LANES
        self._state, self._memory = np.zeros(2 * room), np.zeros((3, forces))
        turn, push = np.zeros((2, room)), np.zeros((forces, 2 * room))
        self._tables = turn, push, np.zeros((2 * forces + sensors, 2 * room)), np.zeros((sensors, forces))
        self._work = np.zeros(2 * forces + sensors), np.zeros(forces), np.zeros(2 * room)
        self._coils = coil_table(exciter.coils, rate)
        numbers = exciter.coils.gain, exciter.coils.clip, exciter.coils.sharpness, 1.0 / rate
        self._amplifier = np.array([numbers], AMPLIFIER)
        self._factor, self._drift = np.ones(modes), ModeDrift(exciter.drift, structure.poles, seed)
        self._receiver = Receiver(exciter.reception, rate, seed)
        self._done = 0
        self._tabulate()

    def run(self, drive: np.ndarray, heard: np.ndarray) -> None:
        """Go on for `drive`, shape (frames, coils) V, and fill `heard`, shape (frames, sensors) m/s^2; C-contiguous."""
        for part, begins in in_blocks(self._done, len(drive)):
            if begins:
                self._begin_block()
            self._run(drive[part], heard[part])
        self._done += len(drive)

    def _run(self, drive: np.ndarray, heard: np.ndarray) -> None:
        run_exciter(
            drive,
            heard,
            self._state,
            self._memory,
            self._tables,
            (self._coils, self._exciter.elements),
            self._amplifier,
            self._work,
        )
        self._receiver.hear(heard)

    def _begin_block(self) -> None:
        self._receiver.begin_block()
        if not self._exciter.drift.is_still:
            self._drift.step(BLOCK / self._rate, self._factor)
            self._tabulate()

    def _tabulate(self) -> None:
        it = self._exciter.structure
        parts = it.poles, it.inlet, it.outlet, it.sensors
        tabulate(parts, self._factor, len(self._coils), 1.0 / self._rate, *self._tables)


def coil_table(coils: Coils, rate: float) -> np.ndarray:
    """Return the kernel's table of coils, shape (coils, 5), at `rate` samples/s."""
    decay = np.exp(-coils.resistance / (coils.inductance * rate))
    return np.stack([coils.factor, coils.resistance, decay, coils.offset, coils.width], axis=1)


def linear_response(exciter: Exciter, frequency: np.ndarray) -> np.ndarray:
    """Return G without nonlinear elements and for a small drive, shape (bins, sensors, coils), m/s^2 per V.

    Parameters
    ----------
    exciter : Exciter
    frequency : array, shape (bins,), Hz
    """
    count, omega = len(exciter.coils.factor), 2 * np.pi * frequency
    here, heard = exciter.structure.response(omega, 1, count)
    forces = exciter.coils.factor[:, None] * coil_currents(exciter.coils, frequency, here[:, :count])
    seen = 1j * omega[:, None] * exciter.reception.sensors.response(frequency)
    whole: np.ndarray = seen[:, :, None] * (heard @ forces)
    return whole


def coil_currents(coils: Coils, frequency: np.ndarray, mobility: np.ndarray) -> np.ndarray:
    """Return the coils' currents per drive, shape (bins, coils, coils), A/V.

    Parameters
    ----------
    coils : Coils
    frequency : array, shape (bins,), Hz
    mobility : array, shape (bins, coils, coils), m/s per N
        The velocities at the coils per force there.

    Source
    ------
    Beranek and Mellow, Acoustics (2012), chapter 6: the coil's impedance and the back-EMF of its motion.
    """
    reactance = 2j * np.pi * frequency[:, None, None] * coils.inductance
    impedance = np.eye(len(coils.factor)) * (coils.resistance + reactance)
    impedance = impedance + coils.factor[:, None] * mobility * coils.factor
    current: np.ndarray = coils.gain * np.linalg.inv(impedance)
    return current


def without_distortion(elements: int) -> np.ndarray:
    """Return nonlinear laws that do nothing, shape (elements, 14), to fill in."""
    laws = np.zeros((elements, COLUMNS))
    laws[:, LUGRE + 3 : LUGRE + 6] = 1.0
    return laws
