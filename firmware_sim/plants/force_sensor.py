"""A force sensor at a robot's wrist: what it makes of a wrench, and all that goes wrong with one."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.flush_kernel import flushed
from firmware_sim.plants.noise_kernel import NOISE_SCALE, four_uniforms
from firmware_sim.plants.options import option, refuse_rate, refuse_wrong_options
from firmware_sim.plants.record import Record
from rigkit.compiled import njit

NEVER = 1e9
"""s, when nothing happens."""
GAGE_OUT_OF_RANGE, ERROR = 1 << 27, 1 << 31
"""Bits of its status, as ATI's: any error, and a strain gage at its end."""
GAGES = np.dtype(
    [
        ("mix", "f8", (6, 6)),  # crosstalk
        # N and N m; the drift is a second's
        ("bias", "f8", 6),
        ("drift", "f8", 6),
        ("noise", "f8", 6),
        ("ends", "f8", 6),  # of the range
        ("pole", "f8"),  # of the low-passes
        ("rate", "f8"),  # samples/s of the plant
        ("sample_rate", "f8"),  # samples/s of its own
        # s, and N
        ("silent", "f8"),
        ("silent_for", "f8"),
        ("stuck", "f8"),
        ("stuck_for", "f8"),
        ("step_at", "f8"),
        ("step", "f8"),
        # state
        ("low", "f8", (2, 6)),  # of the low-passes
        ("shown", "f8", 6),  # the record sent last: wrench,
        ("status", "f8"),
        ("number", "f8"),
        ("done", "i8"),  # samples of the plant
        ("sample", "i8"),  # samples that it has sent
        ("next", "f8"),  # at which of the plant the next is due
    ],
    align=True,
)
"""A sensor."""


@dataclass(eq=False, kw_only=True)
class ForceSensorOptions:
    """How good the sensor is, and what happens to it; defaults of a JR3 100M40A, 400 N and 40 N m.

    Parameters
    ----------
    seed : int
    sample_rate : float, samples/s
    corner : float, Hz, of each of its two low-passes
    noise, moment_noise : float, N and N m rms in each axis
    bias, moment_bias : float, N and N m rms, what it shows of nothing
    drift : float, N a minute, by which that moves; of the moments a tenth, N m
    crosstalk : float, 1 rms, of each axis in each other; between force and moment over 0.1 m
    scale : float, 1
        What it shows over what there is, of all six: another cable, or a box that is set to other counts.
    range_force, range_moment : float, N and N m, where it saturates; along z twice the force
    silent, silent_for : float, s, when it begins to send nothing, and for how long
    stuck, stuck_for : float, s, when its gages go to their end, and for how long
    step_at, step : float, s and N, when its force along y jumps, and how far
    run_number : int
        Which run of the same sensor: from 1 on its noise is another.
    """

    seed: int = option(1, "", 0)
    sample_rate: float = option(500.0, "Hz", 10.0, 8_000.0)
    corner: float = option(150.0, "Hz", 1.0, 10_000.0)
    noise: float = option(0.15, "N", 0.0, 100.0)
    moment_noise: float = option(0.01, "N m", 0.0, 10.0)
    bias: float = option(5.0, "N", 0.0, 1_000.0)
    moment_bias: float = option(0.5, "N m", 0.0, 100.0)
    drift: float = option(0.3, "N", -1_000.0, 1_000.0)
    crosstalk: float = option(0.005, "1", 0.0, 0.1)
    scale: float = option(1.0, "1", 0.01, 100.0)
    range_force: float = option(400.0, "N", 1.0, 1e5)
    range_moment: float = option(40.0, "N m", 0.1, 1e4)
    silent: float = option(NEVER, "s", 0.0)
    silent_for: float = option(NEVER, "s", 0.0)
    stuck: float = option(NEVER, "s", 0.0)
    stuck_for: float = option(NEVER, "s", 0.0)
    step_at: float = option(NEVER, "s", 0.0)
    step: float = option(20.0, "N", -1e4, 1e4)
    run_number: int = option(0, "", 0)

    def __post_init__(self) -> None:
        """Refuse what is out of range."""
        refuse_wrong_options(self)


@njit(cache=True, nogil=True)
def _tell(time: float, step: float, is_stuck: bool, gages: Record, random: np.ndarray) -> None:
    """Measure once, `step` N beside it along y."""
    gages.status = 0.0
    for r in range(6):
        value = gages.bias[r] + gages.drift[r] * time + gages.noise[r] * NOISE_SCALE * four_uniforms(random)
        for c in range(6):
            value += gages.mix[r, c] * gages.low[1, c]
        if r == 1:
            value += step
        if is_stuck or abs(value) >= gages.ends[r]:
            value, gages.status = (gages.ends[r] if value >= 0.0 else -gages.ends[r]), GAGE_OUT_OF_RANGE + ERROR
        gages.shown[r] = value
    gages.number = gages.sample


@njit(cache=True, nogil=True)
def _run(
    wrench: np.ndarray,
    measured: np.ndarray,
    sample: np.ndarray,
    status: np.ndarray,
    sensor: np.ndarray,
    random: np.ndarray,
) -> None:
    """Run one frame; `sensor` is of one `GAGES`, `random` (1,) the state of its noise."""
    gages = sensor[0]
    low, pole = gages.low, gages.pole
    for n in range(wrench.shape[0]):
        for r in range(6):
            low[0, r] = flushed(low[0, r] + pole * (wrench[n, r] - low[0, r]))
            low[1, r] = flushed(low[1, r] + pole * (low[0, r] - low[1, r]))
        if gages.done >= gages.next:
            time = gages.done / gages.rate
            gages.sample += 1
            gages.next = np.ceil(gages.sample * gages.rate / gages.sample_rate)
            if not gages.silent <= time < gages.silent + gages.silent_for:
                is_stuck = gages.stuck <= time < gages.stuck + gages.stuck_for
                _tell(time, gages.step if time >= gages.step_at else 0.0, is_stuck, gages, random)
        for r in range(6):
            measured[n, r] = gages.shown[r]
        sample[n, 0], status[n, 0] = gages.number, gages.status
        gages.done += 1


@dataclass(eq=False)
class ForceSensorPlant(ForceSensorOptions):
    """A wrench in, records out: filtered, with crosstalk, bias, drift and noise, and saturated.

    It does not model: the weight and inertia of what hangs on it, axes that turn with the wrist, hysteresis, its own
    softness and resonance.

    Parameters
    ----------
    rate : float, samples/s, of the wrench, at least `sample_rate`

    Others: those of `ForceSensorOptions`.

    Source
    ------
    JR3 data sheet 100M40A: 400 N and 40 N m, 800 N along its axis; noise 0.15 N [Sörnmo 2015, sec. 7.3].

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    rate: float

    def __post_init__(self) -> None:
        """Draw it."""
        super().__post_init__()
        refuse_rate(self.rate, self.sample_rate, 1e6, "the sensor")
        rng = np.random.default_rng([self.seed, 100])
        arm = np.repeat([1.0, 0.1], 3)
        size = np.repeat([self.bias, self.moment_bias], 3)
        self.range = np.array([1.0, 1.0, 2.0, 1.0, 1.0, 1.0]) * np.repeat([self.range_force, self.range_moment], 3)
        self._gages = gages = np.zeros(1, GAGES)
        gages["mix"] = np.eye(6) + self.crosstalk * rng.standard_normal((6, 6)) * arm[:, None] / arm
        gages["mix"] *= self.scale
        gages["bias"] = size * rng.standard_normal(6)
        gages["drift"] = self.drift / 60 * arm * rng.choice([-1.0, 1.0], 6)
        gages["noise"], gages["ends"] = np.repeat([self.noise, self.moment_noise], 3), self.range
        gages["pole"] = 1.0 - np.exp(-2 * np.pi * self.corner / self.rate)
        gages["rate"], gages["sample_rate"] = self.rate, self.sample_rate
        self._random = rng.integers(1, 2**63, 1, np.uint64)
        if self.run_number:
            rng = np.random.default_rng([self.seed, 100, self.run_number])
            self._random = rng.integers(1, 2**63, 1, np.uint64)

    def run(self, wrench: np.ndarray, measured: np.ndarray, sample: np.ndarray, status: np.ndarray) -> None:
        """Go on for one frame.

        Parameters
        ----------
        wrench : array, shape (frames, 6), N and N m
        measured : array, shape (frames, 6), N and N m, filled in place
            The newest record's.
        sample, status : arrays, shape (frames, 1), filled in place
            Its number, 0 before the first; 0 for healthy, else bits.
        """
        for name in ("silent", "silent_for", "stuck", "stuck_for", "step_at", "step"):
            self._gages[name] = getattr(self, name)
        _run(wrench, measured, sample, status, self._gages, self._random)
