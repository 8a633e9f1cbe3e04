"""A simulated marine vibrator: two coils, two shells, 47 modes to 1300 Hz, and what makes a real one hard to drive."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.immersion import FLUID_MASS, immersed_modes, with_radiation
from firmware_sim.plants.modal_drift import ModalDrift
from firmware_sim.plants.vibrator_kernel import add_pickup, retune, run_modes
from firmware_sim.plants.vibrator_modes import SPRING_STIFFNESS, Modes, lumped_modes, vibrator_modes
from firmware_sim.plants.vibrator_options import VibratorOptions

NOMINAL_RESPONSE = 10.0
"""m/s^2, what noise and hum in dB refer to."""
FORCE_FACTOR = 260.0
"""N/V at rest, amplifier included."""
COIL_CORNER = 1500.0
"""Hz, the coil's R / (2 pi L)."""
BACK_EMF = 0.002
"""V per (N/V x m/s): how far the amplifier's output resistance lets the back-EMF through."""
AMPLIFIER_CLIP = 30.0
"""V."""
COIL_OFFSET, COIL_REACH = 0.5e-3, 2.5e-3
"""m: the coil rests off the middle of its field; displacement from there that halves the force factor."""
STIFFENING, SAG = 1.05e-3, 0.18e-3
"""m: elongation at which the cubic force equals the linear one, and the spring element's elongation at rest."""
STOP_GAP, STOP_STIFFNESS = 0.15e-3, 0.08
"""m and 1 (of the spring's): a rubber stop on one side, which rattles."""
SPRING_FRICTION, SPRING_SLIP = 1.8e-6, 12e-6
"""m and m: friction force over the spring's stiffness, and travel until it slips."""
JOINT_FRICTION, JOINT_SLIP = 2.2, 0.5e-6
"""N and m: friction in the shell's bolted joints.  They stick at small motion and stiffen every flexural mode."""
RETUNE_EVERY = 4096
"""Samples between two steps of the drift."""


@dataclass(eq=False)
class VibratorPlant(VibratorOptions):
    """Two coil voltages in, two shell accelerations out, sample by sample; the options are those of `VibratorOptions`.

    A lumped model (two coils, two shells, a frame) gives the two wanted resonances near 34 and 76 Hz; 37 flexural
    modes to 640 Hz, of one side at the lower end and of both above 180 Hz, give peaks, notches, cross coupling and
    zeros outside the unit circle; five more to 1300 Hz stand for all above.  The nonlinear forces act inside: a spring
    that stiffens about its sag, a stop on one side, friction in the spring and in the shell's bolted joints (Dahl's
    model; the joints stick when nothing else moves them, which is why an unloaded measurement shows another machine),
    a force factor that falls away from the middle of the field.

    It does not model: temperature and depth but as `trend`, heat in the coils, saturation of the accelerometers and of
    the converters, clock drift, wear; in water, what the load does to the shapes of the modes.

    Parameters
    ----------
    rate : float, samples/s, >= 8000

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Draw it, at rest."""
        super().__post_init__()
        if not 8_000 <= self.rate <= 1e6:
            raise ValueError(f"rate is {self.rate!r} samples/s, must be 8000 to 1e6 for the simulated vibrator")
        self._rng = np.random.default_rng(self.seed)
        self._modes = modes = self.draw_modes(self._rng)
        self._drift = ModalDrift(modes, self, self._rng)
        count = len(modes.frequency)
        self._moved = self._heard = 0
        self._motion, self._memory = np.zeros((2, count)), np.zeros(6)
        self._recursion, self._shapes = np.zeros((6, count)), np.zeros((10, count))
        forces = np.concatenate([modes.coil, modes.spring, modes.joint])
        self._shapes[:6] = forces
        self._direct = modes.shell @ forces.T
        self._constants = _constants(self.rate, self.nonlinearity)
        self._noise = np.zeros((RETUNE_EVERY, 2))
        self._noise_rms, self._hum_size = (NOMINAL_RESPONSE * 10 ** (level / 20) for level in (self.noise, self.hum))

    def draw_modes(self, rng: np.random.Generator) -> Modes:
        """Draw what moves."""
        return immersed_modes(rng) if self.medium == "water" else vibrator_modes(rng)

    def run(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Go on for `drive` (frames, 2) V and fill `response` (frames, 2) m/s^2, both C-contiguous float64."""
        self.accelerate(drive, response)
        self.pick_up(response)

    def accelerate(self, drive: np.ndarray, shells: np.ndarray) -> None:
        """Go on for `drive` (frames, 2) V and fill `shells` (frames, 2) m/s^2 with how they move, without sensors."""
        done = 0
        while done < len(drive):
            into = self._moved % RETUNE_EVERY
            if into == 0:
                self._retune()
            end = min(len(drive), done + RETUNE_EVERY - into)
            run_modes(
                drive[done:end],
                shells[done:end],
                self._motion,
                self._memory,
                self._recursion,
                self._shapes,
                self._direct,
                self._constants,
            )
            self._moved += end - done
            done = end

    def pick_up(self, response: np.ndarray) -> None:
        """Add to `response` (frames, 2) m/s^2, in place, the noise and hum of the next samples."""
        cycles = self.hum_frequency / self.rate
        for start in range(0, len(response), RETUNE_EVERY):
            heard = response[start : start + RETUNE_EVERY]
            noise = self._noise[: len(heard)]
            self._rng.standard_normal(out=noise)
            add_pickup(heard, noise, self._noise_rms, self._hum_size, cycles, self._heard)
            self._heard += len(heard)

    def _retune(self) -> None:
        modes, step = self._modes, 1.0 / self.rate
        frequency = self._drift.at(self._moved * step)
        retune(frequency, modes.damping, modes.shell, step, self._recursion, self._shapes)


class LumpedVibratorPlant(VibratorPlant):
    """The same two coils and shells on their frame, with every nonlinear force, but without flexure."""

    def draw_modes(self, rng: np.random.Generator) -> Modes:
        """Draw coils, shells and frame."""
        return with_radiation(lumped_modes(rng, FLUID_MASS)) if self.medium == "water" else lumped_modes(rng, 0.0)


def _constants(rate: float, nonlinearity: float) -> np.ndarray:
    """Name and order of the kernel's constants."""
    return np.array(
        [
            np.exp(-2 * np.pi * COIL_CORNER / rate),
            BACK_EMF,
            1.0 / rate,
            AMPLIFIER_CLIP,
            FORCE_FACTOR,
            COIL_OFFSET,
            COIL_REACH / np.sqrt(max(nonlinearity, 1e-12)),
            nonlinearity * SPRING_STIFFNESS / STIFFENING**2,
            SAG,
            nonlinearity * SPRING_STIFFNESS * STOP_STIFFNESS,
            STOP_GAP,
            nonlinearity * SPRING_STIFFNESS * SPRING_FRICTION,
            SPRING_SLIP,
            nonlinearity * JOINT_FRICTION,
            JOINT_SLIP,
        ]
    )
