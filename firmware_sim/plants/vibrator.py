"""A simulated marine vibrator: two coils, two shells, 47 modes to 1300 Hz, and what makes a real one hard to drive."""

import numpy as np

from firmware_sim.plants.vibrator_kernel import add_pickup, retune, run_modes
from firmware_sim.plants.vibrator_modes import SPRING_STIFFNESS, vibrator_modes

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
DRIFT_PERIODS = (600.0, 2400.0)
"""s, of the slow swing of each mode's frequency."""
RETUNE_EVERY = 4096
"""Samples between two steps of the drift."""

Range = tuple[float, float]
RANGES: dict[str, tuple[str, Range]] = {
    "nonlinearity": ("1", (0.0, 5.0)),
    "drift": ("1", (0.0, 0.1)),
    "noise": ("dB", (-400.0, 0.0)),
    "hum": ("dB", (-400.0, 0.0)),
    "hum_frequency": ("Hz", (16.0, 400.0)),
}


class VibratorPlant:
    """Two coil voltages in, two shell accelerations out, sample by sample.

    A lumped model (two coils, two shells, a frame) gives the two wanted resonances near 34 and 76 Hz; 37 flexural
    modes to 640 Hz, of one side at the lower end and of both above 180 Hz, give peaks, notches, cross coupling and
    zeros outside the unit circle; five more to 1300 Hz stand for all above.  The nonlinear forces act inside: a spring
    that stiffens about its sag, a stop on one side, friction in the spring and in the shell's bolted joints (Dahl's
    model; the joints stick when nothing else moves them, which is why an unloaded measurement shows another machine),
    a force factor that falls away from the middle of the field.

    It does not model: the water's load and radiation beyond an added mass, the far field, temperature and depth, heat
    in the coils, saturation of the accelerometers and of the converters, clock drift, wear.

    Parameters
    ----------
    rate : float, samples/s, >= 8000
    seed : int, which vibrator: masses, springs, modes, drift and noise are drawn from it
    nonlinearity : float, 1, 0 to 5, scales every nonlinear force
    drift : float, 1, 0 to 0.1, swing of each mode's frequency, relative, over 10 to 40 minutes
    noise : float, dB re 10 m/s^2, rms of the sensors' white noise
    hum : float, dB re 10 m/s^2, amplitude of the mains' pick-up; its third harmonic is 20 dB weaker
    hum_frequency : float, Hz

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    def __init__(
        self,
        rate: float,
        seed: int = 1,
        nonlinearity: float = 1.0,
        drift: float = 0.002,
        noise: float = -75.0,
        hum: float = -60.0,
        hum_frequency: float = 50.0,
    ) -> None:
        _check(rate, seed, locals())
        rng = np.random.default_rng(seed)
        modes = vibrator_modes(rng)
        count = len(modes.frequency)
        self._modes, self._rng, self._step, self._sample = modes, rng, 1.0 / rate, 0
        self._swing = drift * np.ones(count)
        self._pace = 2 * np.pi / rng.uniform(*DRIFT_PERIODS, count)
        self._phase = rng.uniform(0, 2 * np.pi, count)
        self._frequency = modes.frequency.copy()
        self._motion, self._memory = np.zeros((2, count)), np.zeros(6)
        self._recursion, self._shapes = np.zeros((6, count)), np.zeros((10, count))
        self._shapes[:6] = np.concatenate([modes.coil, modes.spring, modes.joint])
        forces = np.concatenate([modes.coil, modes.spring, modes.joint])
        self._direct = modes.shell @ forces.T
        self._constants = _constants(rate, nonlinearity)
        self._noise = np.zeros((RETUNE_EVERY, 2))
        self._noise_rms = NOMINAL_RESPONSE * 10 ** (noise / 20)
        self._hum = NOMINAL_RESPONSE * 10 ** (hum / 20)
        self._hum_cycles = hum_frequency / rate

    def run(self, drive: np.ndarray, response: np.ndarray) -> None:
        """Go on for `drive` (frames, 2) V and fill `response` (frames, 2) m/s^2, both C-contiguous float64."""
        done = 0
        while done < len(drive):
            into = self._sample % RETUNE_EVERY
            if into == 0:
                self._drift()
            end = min(len(drive), done + RETUNE_EVERY - into)
            out, noise = response[done:end], self._noise[: end - done]
            run_modes(
                drive[done:end],
                out,
                self._motion,
                self._memory,
                self._recursion,
                self._shapes,
                self._direct,
                self._constants,
            )
            self._rng.standard_normal(out=noise)
            add_pickup(out, noise, self._noise_rms, self._hum, self._hum_cycles, self._sample)
            self._sample += end - done
            done = end

    def _drift(self) -> None:
        """Move every mode to where its slow swing has it now; at the start each is at its drawn frequency."""
        seconds = self._sample * self._step
        np.multiply(self._pace, seconds, out=self._frequency)
        self._frequency += self._phase
        np.sin(self._frequency, out=self._frequency)
        self._frequency -= np.sin(self._phase)
        self._frequency *= self._swing
        self._frequency += 1.0
        self._frequency *= self._modes.frequency
        retune(self._frequency, self._modes.damping, self._modes.shell, self._step, self._recursion, self._shapes)


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


def _check(rate: float, seed: object, options: dict[str, object]) -> None:
    if not 8_000 <= rate <= 1e6:
        raise ValueError(f"rate is {rate!r} samples/s, must be 8000 to 1e6 for the simulated vibrator")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise ValueError(f"simulator.options.seed is {seed!r}, must be a whole number >= 0")
    for name, (unit, (low, high)) in RANGES.items():
        value = options[name]
        if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
            raise ValueError(f"simulator.options.{name} is {value!r}, must be {low:g} to {high:g} {unit}")
