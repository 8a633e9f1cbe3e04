"""A moving-coil vibrator as loudspeaker engineers see one: coils in magnets, suspensions, plates, gas behind them."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants import moving_coil_kernel as kernel
from firmware_sim.plants.options import refuse_rate
from firmware_sim.plants.reception import BLOCK, Receiver, Reception, in_blocks
from firmware_sim.plants.suspension_drift import Softening, SuspensionDrift

FASTEST = 1.6
"""1: a step times the fastest rate there is, at most; the rule is stable to 2.7."""


@dataclass(frozen=True)
class Motor:
    """Coils in their magnets, each behind its channel of a voltage amplifier.

    Parameters
    ----------
    gain : float, V/V
    factor : array, shape (units,), N/A
        The force factor Bl at rest.
    resistance, inductance : arrays, shape (units,), ohm and H
        R_e, cold, cable included, and L_e at rest.
    iron_resistance, iron_inductance : arrays, shape (units,), ohm and H
        R_2 and L_2, for eddy currents: side by side, and in series with the coil.
    """

    gain: float
    factor: np.ndarray
    resistance: np.ndarray
    inductance: np.ndarray
    iron_resistance: np.ndarray
    iron_inductance: np.ndarray


@dataclass(frozen=True)
class Moving:
    """What moves, for small excursions.

    Parameters
    ----------
    mass, stiffness, damping : arrays, shape (units,), kg, N/m and N s/m
        Plate, coil and the water that goes with them; K_ms when shaken, and R_ms.
    creep : array, shape (units, branches, 2)
        Stiffness, N/m, and rate, 1/s, of what relaxes; held still, a suspension keeps its stiffness less all these.
    area, facing : arrays, shape (units,), m^2 and 1
        Of each plate, and the cosine of its direction to the housing's.
    modes : array, shape (units, modes, 4)
        Of the plates: frequency Hz, damping 1, and shape at coil and sensor for a modal mass of the plate's.
    housing, mount, loss : float, kg, N/m and N s/m
        Mass that bears the magnets, and its mounts.
    pressure, volume, ratio : float, Pa, m^3 and 1
        Of the gas in the housing.
    """

    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    creep: np.ndarray
    area: np.ndarray
    facing: np.ndarray
    modes: np.ndarray
    housing: float
    mount: float
    loss: float
    pressure: float
    volume: float
    ratio: float


@dataclass(frozen=True)
class LargeSignal:
    """What changes with excursion, speed and current; as it stands, nothing but the gas.

    Parameters
    ----------
    excursion : float, m
        x_max: where the laws below are what their numbers say.
    field : (float, float)
        Bl falls as 1 / (1 + a z^2 + b z^4), z being how far the coil is off the field's middle over x_max.
    offset : tuple of float
        Where the field's middle is, over x_max, for each unit.
    spring : (float, float, float)
        K is 1 + p z + q z^2 + r z^4 times that at rest.
    modulation : float, 1
        L_e and L_2 are 1 - m z / sqrt(1 + z^2) times those at rest.
    saturating, saturation : float, 1 and A
        The part of L_e that fades as iron saturates, and the current at which it does.
    speed : float, m/s
        Where R_ms has risen by sqrt(2).
    seal : tuple of (float, float)
        A seal as springs that slip: stiffness, N/m, and force, N, of each.
    """

    excursion: float = 1.0
    field: tuple[float, float] = (0.0, 0.0)
    offset: tuple[float, ...] = (0.0,)
    spring: tuple[float, float, float] = (0.0, 0.0, 0.0)
    modulation: float = 0.0
    saturating: float = 0.0
    saturation: float = 1.0
    speed: float = 1e9
    seal: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Heating:
    """What a coil's losses do to it.

    Parameters
    ----------
    rise, time : float, K/W and s
        Of a coil over its magnet; 0 K/W for a coil that stays cold.
    magnet_rise, magnet_time : float, K/W and s
    """

    rise: float = 0.0
    time: float = 1.0
    magnet_rise: float = 0.0
    magnet_time: float = 1.0


@dataclass(frozen=True)
class MovingCoil:
    """A vibrator, whole.

    Parameters
    ----------
    motor : Motor
    moving : Moving
    large : LargeSignal
    heating : Heating
    softening : Softening
    reception : Reception
    """

    motor: Motor
    moving: Moving
    large: LargeSignal
    heating: Heating
    softening: Softening
    reception: Reception


class MovingCoilPlant:
    """A `MovingCoil` sample by sample, from rest.

    It does not model: rocking of a plate, coils that hit their magnets, flux that the current takes from the magnet,
    the amplifier's own limits and noise, leaks of the gas, sound between the plates, clocks that drift.

    Parameters
    ----------
    vibrator : MovingCoil
    rate : float, samples/s, 8000 to 1e6
    seed : int
        Of its noise and of what wanders.

    Source
    ------
    Klippel, Tutorial: Loudspeaker nonlinearities - causes, parameters, symptoms, J. Audio Eng. Soc. 54 (2006) 907:
    the equations of motor, suspension and gas.  Knudsen and Jensen, Low-frequency loudspeaker models that include
    suspension creep, ibid. 41 (1993) 3.  Button, Heat dissipation and power compression in loudspeakers, ibid. 40
    (1992) 32: two stages of heat.  Sherman and Butler, Transducers and Arrays for Underwater Sound (2007), on
    moving-coil projectors: the housing and its gas.  Iwan, J. Applied Mechanics 33 (1966) 893: the seal.
    """

    def __init__(self, vibrator: MovingCoil, rate: float, seed: int) -> None:
        refuse_rate(rate, 8_000, 1e6, "a simulated vibrator")
        moving, heating = vibrator.moving, vibrator.heating
        units, modes = moving.modes.shape[:2]
        self._gain, self._rate = vibrator.motor.gain, rate
        self._machine = machine_tables(vibrator)
        self._thermal = np.array([heating.rise, heating.time, heating.magnet_rise, heating.magnet_time])
        shape = units + 1, kernel.CREPT + moving.creep.shape[1] + 2 * modes
        seal = np.zeros((units, len(vibrator.large.seal))), np.zeros(units)
        self._worked = np.zeros(units)
        hot = vibrator.motor.resistance.copy()
        self._memory = np.zeros(shape), np.zeros((units, 2)), hot, seal, self._worked
        steps = steps_of_a_sample(self._machine, rate)
        self._timing = 1.0 / (rate * steps), steps
        self._work = np.zeros((5, *shape)), np.zeros(units), np.zeros((units, 2)), np.zeros(shape)
        self._drift = SuspensionDrift(vibrator.softening, units, seed)
        self._receiver = Receiver(vibrator.reception, rate, seed)
        self._done = 0

    def run(self, drive: np.ndarray, heard: np.ndarray) -> None:
        """Go on for `drive`, shape (frames, units) V, and fill `heard`, shape (frames, units) m/s^2; C-contiguous."""
        for part, begins in in_blocks(self._done, len(drive)):
            if begins:
                self._begin_block()
            self._run(drive[part], heard[part])
        self._done += len(drive)

    def _run(self, drive: np.ndarray, heard: np.ndarray) -> None:
        kernel.run_moving_coils(
            drive, heard, self._gain, self._machine, self._thermal, self._memory, self._timing, self._work
        )
        self._receiver.hear(heard)

    def _begin_block(self) -> None:
        self._receiver.begin_block()
        self._worked /= BLOCK
        self._drift.step(BLOCK / self._rate, self._worked, self._machine[0][:, kernel.SOFT])
        self._worked[:] = 0.0


def machine_tables(vibrator: MovingCoil) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the kernel's tables: unit, modes, creep, slips and body, of the shapes that it gives."""
    moving, large = vibrator.moving, vibrator.large
    omega = 2 * np.pi * moving.modes[:, :, 0]
    modes = np.stack([omega**2, 2 * moving.modes[:, :, 1] * omega, moving.modes[:, :, 2], moving.modes[:, :, 3]], 2)
    slips = np.tile(np.reshape(large.seal, (-1, 2)).astype(float), (len(moving.mass), 1, 1))
    body = [moving.housing, moving.mount, moving.loss, moving.pressure, moving.volume, moving.ratio]
    return _unit_table(vibrator), np.ascontiguousarray(modes), moving.creep.copy(), slips, np.array(body)


def _unit_table(vibrator: MovingCoil) -> np.ndarray:
    motor, moving, large = vibrator.motor, vibrator.moving, vibrator.large
    columns: dict[int, np.ndarray | float] = {
        kernel.MASS: moving.mass,
        kernel.STIFFNESS: moving.stiffness,
        kernel.RELAXED: moving.stiffness - moving.creep[:, :, 0].sum(axis=1),
        kernel.DAMPING: moving.damping,
        kernel.SPEED: 1.0 / large.speed,
        kernel.AREA: moving.area,
        kernel.FACING: moving.facing,
        kernel.SOFT: 1.0,
        kernel.ASYMMETRY: large.spring[0],
        kernel.QUADRATIC: large.spring[1],
        kernel.QUARTIC: large.spring[2],
        kernel.LIMIT: 1.0 / large.excursion,
        kernel.FACTOR: motor.factor,
        kernel.FIELD_2: large.field[0],
        kernel.FIELD_4: large.field[1],
        kernel.OFFSET: np.array(large.offset),
        kernel.RESISTANCE: motor.resistance,
        kernel.INDUCTANCE: motor.inductance,
        kernel.IRON_INDUCTANCE: motor.iron_inductance,
        kernel.IRON_RESISTANCE: motor.iron_resistance,
        kernel.MODULATION: large.modulation,
        kernel.SATURATING: large.saturating,
        kernel.SATURATION: 1.0 / large.saturation,
    }
    table = np.zeros((len(moving.mass), kernel.COLUMNS))
    for column, values in columns.items():
        table[:, column] = values
    return table


def steps_of_a_sample(machine: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray], rate: float) -> int:
    """Return how many steps make a sample at `rate` samples/s, an odd number, so that one has the sample's middle."""
    unit, modes = machine[:2]
    least = (1 - unit[:, kernel.MODULATION]) * (1 - unit[:, kernel.SATURATING])
    electric = (unit[:, kernel.RESISTANCE] + unit[:, kernel.IRON_RESISTANCE]) / unit[:, kernel.INDUCTANCE] / least
    iron = unit[:, kernel.IRON_RESISTANCE] / unit[:, kernel.IRON_INDUCTANCE] / (1 - unit[:, kernel.MODULATION])
    fastest = max(float((electric + iron).max()), float(np.sqrt(modes[:, :, kernel.SQUARE].max(initial=0.0))))
    return 2 * (int(np.ceil(fastest / (FASTEST * rate))) // 2) + 1
