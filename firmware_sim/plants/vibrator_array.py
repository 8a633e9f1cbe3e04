"""Several vibrators side by side: each hears its neighbours, and hydrophones hear them all."""

from dataclasses import dataclass

import numpy as np

from firmware_sim.plants.immersion import DENSITY, MEAN_SHAPE, SOUND_SPEED
from firmware_sim.plants.options import option
from firmware_sim.plants.sound_paths import SoundPaths
from firmware_sim.plants.vibrator import NOMINAL_RESPONSE, VibratorPlant
from firmware_sim.plants.vibrator_modes import SHELL_AREA
from firmware_sim.plants.vibrator_options import VibratorOptions

HALF_LENGTH = 0.5
"""m, from a vibrator's middle to either shell."""
SEED_STEP = 1000
"""Between the seeds of neighbours."""
CHUNK = 1024
"""Samples worked on at a time."""


@dataclass(eq=False, kw_only=True)
class ArrayOptions(VibratorOptions):
    """How many vibrators and hydrophones there are, and where; what else happens, happens to each vibrator alike.

    Parameters
    ----------
    vibrators : int
        The first is the one of `seed`, the next are those of `seed` + 1000, + 2000 ...
    crosstalk : float, dB
        What a vibrator's shells are moved by a neighbour `spacing` away, against how that one moves itself: rms over
        shells that move independently.  It falls with distance and comes with the delay of sound.
    spacing : float, m, between neighbours, side by side
    hydrophones : int
    distance : float, m, from the middle of the array to every hydrophone
        The first looks at the array's broad side, along the vibrators' axes; the others stand on an arc from there to
        its end.
    far_field_noise : float, dB re all shells at 10 m/s^2 in phase
        A hydrophone's white noise, rms.

    Raises
    ------
    ValueError : an option outside its range, by name.
    """

    vibrators: int = option(2, "", 1, 16)
    crosstalk: float = option(-20.0, "dB", -400.0, -6.0)
    spacing: float = option(3.0, "m", 1.0, 100.0)
    hydrophones: int = option(1, "", 1, 16)
    distance: float = option(10.0, "m", 1.0, 150.0)
    far_field_noise: float = option(-70.0, "dB", -400.0, 0.0)


@dataclass(eq=False)
class VibratorArrayPlant(ArrayOptions):
    """Two voltages a vibrator in; two shell accelerations a vibrator and the pressure at each hydrophone out.

    Every shell radiates as a point source with its volume acceleration, half its face times the accelerometer's a:
    p = rho S a(t - r/c) / (8 pi r).  A neighbour's shells follow the pressure at them at once and all of a piece,
    whatever their own resonances; hydrophones hear what all shells do in the end.  In air the same holds with air's
    density and speed of sound; what crosstalk there is then comes through what both hang on, but is modelled alike.

    It does not model: the surface and the bottom, that flexed shells displace other volumes than bulging ones,
    sound going round a vibrator's body, and a second crossing from neighbour to neighbour.

    Parameters
    ----------
    rate : float, samples/s, >= 8000

    Source
    ------
    Kinsler and others, Fundamentals of Acoustics (2000), simple source.
    """

    rate: float

    def __post_init__(self) -> None:
        """Draw the vibrators, at rest, in still water."""
        super().__post_init__()
        self._refuse_hydrophones_within()
        shared = {name: getattr(self, name) for name in VibratorOptions.__dataclass_fields__ if name != "seed"}
        seeds = range(self.seed, self.seed + SEED_STEP * self.vibrators, SEED_STEP)
        self._vibrators = [VibratorPlant(self.rate, seed=seed, **shared) for seed in seeds]
        self._rng = np.random.default_rng([self.seed, self.vibrators])
        far, far_delay = self._far_field()
        self._paths = SoundPaths(*self._crosstalk(), far, far_delay, CHUNK)
        self._noise_rms = 10 ** (self.far_field_noise / 20) * NOMINAL_RESPONSE * far.sum(axis=1).mean()
        self._drive, self._shells = np.zeros((CHUNK, 2)), np.zeros((self.vibrators, CHUNK, 2))
        self._noise = np.zeros((CHUNK, self.hydrophones))

    def run(self, drive: np.ndarray, response: np.ndarray, far_field: np.ndarray) -> None:
        """Go on.

        Parameters
        ----------
        drive : array, shape (frames, 2 vibrators), V
        response : array, shape (frames, 2 vibrators), m/s^2
            Filled.
        far_field : array, shape (frames, hydrophones), Pa
            Filled.
        """
        for start in range(0, len(drive), CHUNK):
            end = min(start + CHUNK, len(drive))
            self._run(drive[start:end], response[start:end], far_field[start:end])

    def _run(self, drive: np.ndarray, response: np.ndarray, far_field: np.ndarray) -> None:
        frames = len(drive)
        own, shells, noise = self._drive[:frames], self._shells[:, :frames], self._noise[:frames]
        for index, vibrator in enumerate(self._vibrators):
            own[:] = drive[:, 2 * index : 2 * index + 2]
            vibrator.accelerate(own, shells[index])
        self._rng.standard_normal(out=noise)
        noise *= self._noise_rms
        far_field[:] = noise
        self._paths.run(shells, far_field)
        for index, vibrator in enumerate(self._vibrators):
            vibrator.pick_up(shells[index])
            response[:, 2 * index : 2 * index + 2] = shells[index]

    def _refuse_hydrophones_within(self) -> None:
        nearest = self.spacing * (self.vibrators - 1) / 2 + 2 * HALF_LENGTH
        if self.distance < nearest:
            raise ValueError(
                f"simulator.options.distance is {self.distance:g} m, must be >= {nearest:g} m: {self.vibrators} "
                f"vibrators {self.spacing:g} m apart are in the way"
            )

    def _shell_places(self) -> np.ndarray:
        """Where each shell is, shape (shells, 2), m: the array stands along the second axis."""
        row = self.spacing * (np.arange(self.vibrators) - (self.vibrators - 1) / 2)
        return np.array([(x, y) for y in row for x in (-HALF_LENGTH, HALF_LENGTH)])

    def _crosstalk(self) -> tuple[np.ndarray, np.ndarray]:
        """Return gain, 1, and delay, samples, from shell to shell, shape (shells, shells); none within a vibrator."""
        places = self._shell_places()
        apart = np.linalg.norm(places[:, None] - places[None], axis=-1)
        neighbours = np.array([self.spacing, self.spacing, *2 * [np.hypot(self.spacing, 2 * HALF_LENGTH)]])
        size = 10 ** (self.crosstalk / 20) / np.sqrt((1 / neighbours**2).sum() / 2)
        others = np.kron(1 - np.eye(self.vibrators), np.ones((2, 2))) > 0
        gain = np.where(others, -size / np.where(others, apart, 1.0), 0.0)  # pressure pushes inwards
        return gain, self._delay(apart)

    def _far_field(self) -> tuple[np.ndarray, np.ndarray]:
        """Return gain, Pa per m/s^2, and delay, samples, from shells to hydrophones, shape (hydrophones, shells)."""
        angle = np.pi / 2 * np.arange(self.hydrophones) / self.hydrophones
        places = self.distance * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        apart = np.linalg.norm(places[:, None] - self._shell_places()[None], axis=-1)
        source = DENSITY[self.medium] * MEAN_SHAPE * SHELL_AREA / (4 * np.pi)  # Pa m per m/s^2
        return source / apart, self._delay(apart)

    def _delay(self, apart: np.ndarray) -> np.ndarray:
        delay: np.ndarray = np.rint(apart / SOUND_SPEED[self.medium] * self.rate).astype(np.int64)
        return delay
