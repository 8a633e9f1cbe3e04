"""A simulated piezo stage: three stacks with hysteresis and creep, levers, resonant flexure, and its sensors."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.options import refuse_rate
from firmware_sim.plants.piezo_stage_actuator import CREEP_TIMES, PLAYS, draw_actuators
from firmware_sim.plants.piezo_stage_kernel import CONVERTER_STEPS, SHOWN, run_stage
from firmware_sim.plants.piezo_stage_modes import PIEZO_STIFFNESS, StageModes, stage_modes
from firmware_sim.plants.piezo_stage_options import PiezoStageOptions

GAUGE_NOISE, PLATE_NOISE, LASER_NOISE = 15e-9, 25e-9, 100e-9
"""m rms of strain gauges, capacitive sensors (0.005 % of their range) and laser, white up to half the rate."""
GAUGE_RANGE, PLATE_RANGE, LASER_RANGE = (-10e-6, 130e-6), (-50e-6, 600e-6), (-15e-3, 15e-3)
"""m, what 16-bit converters cover; the laser's is that of a Keyence LK-G87."""
LASER_STEP = 0.2e-6
"""m [Sörnmo 2015, sec. 2.2: "with a resolution of 0.2 um"]."""
GAUGE_GAIN_SPREAD = 0.005
"""Relative standard deviation of the gauges' gains, cut off at two of it."""


@dataclass(eq=False)
class PiezoStagePlant(PiezoStageOptions):
    """Piezo voltages, process forces and the robot's displacement in; stacks, plate and laser out, sample by sample.

    A stack's free expansion follows its voltage through amplifier, saturating polarization, ten plays with lag and six
    slow terms; it drives the assembled mechanics through the stack's own stiffness, as process forces do at the plate,
    so what loads a stack shows on its strain gauge.  Below 150 Hz there are three resonances on x, two on y, one on z;
    x and z are coupled a little, y is not.  `modes` has them all.

    The recursion is that of the matrix exponential for expansion and force held over a sample.  A frame's last output
    is the state at its end, `delay` samples late.  The robot carries the workpiece (Sörnmo 2015, sec. 2.2), so `base`
    moves what the laser sees and does not shake the stage.

    It does not model: heat in the stacks and in the room, hysteresis that depends on load, flexure that stiffens with
    travel, end stops, cross talk between sensors, the spindle's gyroscopic moments, rotations of the plate.

    Parameters
    ----------
    rate : float, samples/s, 5000 to 1e5

    Others: those of `PiezoStageOptions`.

    Source
    ------
    Sörnmo 2015, sec. 2.2 to 2.4; Krejci and Kuhnen, IEE Proc. Control Theory Appl. 148 (2001) 185, for plays that lag
    and creep; numbers where they stand.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Draw it, at rest, depolarized, at 0 V."""
        super().__post_init__()
        refuse_rate(self.rate, 5_000, 1e5, "the simulated stage")
        if not self.laser_rate <= self.rate:
            raise ValueError(f"simulator.options.laser_rate is {self.laser_rate!r}, must be at most {self.rate:g} Hz")
        rng = np.random.default_rng(self.seed)
        self.modes = stage_modes(rng, self.coupling, self.frequency_scale)
        self._actuators = draw_actuators(rng, self.rate, self.hysteresis, self.creep)
        self._shown = np.zeros(1, SHOWN)
        self._shown["gauge"] = self.noise * GAUGE_NOISE, *_converter(GAUGE_RANGE)
        self._shown["plate"] = self.noise * PLATE_NOISE, *_converter(PLATE_RANGE)
        self._shown["laser"] = self.noise * LASER_NOISE, LASER_STEP, *LASER_RANGE
        self._shown["gain"] = 1 + GAUGE_GAIN_SPREAD * np.clip(rng.standard_normal(3), -2, 2)
        self._shown["cycles"] = self.laser_rate / self.rate
        self._mechanics = _mechanics(self.modes, self.rate)
        self._motion = np.zeros((2, len(self.modes.frequency)))
        self._stacks = np.zeros((3, 1 + PLAYS + len(CREEP_TIMES)))
        self._line = np.zeros((self.delay + 1, 6))
        self._random = rng.integers(1, 2**63, 1, np.uint64)

    def run(
        self,
        voltage: np.ndarray,
        force: np.ndarray,
        base: np.ndarray,
        extension: np.ndarray,
        position: np.ndarray,
        absolute: np.ndarray,
    ) -> None:
        """Go on for one frame.

        Parameters
        ----------
        voltage, force, base : arrays, shape (frames, 3), V, N and m
            Of stacks, on the plate, and of the robot; axes x y z.
        extension, position, absolute : arrays, shape (frames, 3), m
            Filled in place: strain gauges, capacitive sensors, and the laser (plate plus robot).
        """
        signals, tables = (voltage, force, base, extension, position, absolute), (self._actuators, self._mechanics)
        run_stage(signals, self._motion, self._stacks, self._line, *tables, self._shown, self._random)


def _mechanics(modes: StageModes, rate: float) -> np.ndarray:
    """Return the kernel's table of recursion and shapes, shape (17, modes)."""
    step, omega = 1 / rate, 2 * np.pi * modes.frequency
    sigma = modes.damping * omega
    ringing = omega * np.sqrt(1 - modes.damping**2)
    shrink, cosine, sine = np.exp(-sigma * step), np.cos(ringing * step), np.sin(ringing * step) / ringing
    kept, carried = shrink * (cosine + sigma * sine), shrink * sine
    recursion = [kept, carried, -(omega**2) * carried, shrink * (cosine - sigma * sine), (1 - kept) / omega**2]
    return np.vstack([*recursion, PIEZO_STIFFNESS * modes.extension, modes.plate, modes.extension, modes.plate])


def _converter(between: tuple[float, float]) -> tuple[float, float, float]:
    """Return the step of a converter and its range, m."""
    return (between[1] - between[0]) / CONVERTER_STEPS, *between
