"""Where the priors of `vibractl predict` come from: distortion of a first shot, simulated vibrators beside drawn ones.

`python -m benchmarks.distortion_prior [SEED ...]`, two seconds a seed.  What G does not explain of the response to
G^+ R, over how the vibrator answers at the line re in the reference's band; rms of bands, dB re the reference's level.
"""

import sys

import numpy as np

from benchmarks.measured_pairs import identified
from firmware_sim.plants.vibrator import VibratorPlant
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.learning.law import reference_level
from vibractl.predict.plant import DrawnPlant
from vibractl.setup import Setup, setup
from vibractl.spectrum import LineSpectrum

SEEDS = range(11, 21)
EDGES = (40, 90, 115, 140, 165, 190, 215, 240, 265, 300, 350, 400, 450, 500, 570, 645)
"""Hz."""


def profile(made: Setup, distortion: np.ndarray) -> np.ndarray:
    """Return the level of a distortion (lines, outputs), m/s^2 s, in each band, dB."""
    response, wanted = made.law.matrix.response, np.abs(made.law.reference) ** 2
    size = np.linalg.norm(response, axis=2)
    usual = np.sqrt((size**2 * wanted).sum(axis=0) / wanted.sum(axis=0))
    power = np.abs(distortion * usual / size / reference_level(made.law.reference)) ** 2
    place = np.searchsorted(EDGES, made.law.matrix.frequency, side="right")
    return np.array([10 * np.log10(power[place == band].mean()) for band in range(1, len(EDGES))])


def simulated(made: Setup, seed: int) -> np.ndarray:
    learner, plant = made.learner(), VibratorPlant(made.shot.rate, seed=seed)
    response = np.zeros(learner.drive.shape)
    plant.run(learner.drive.astype(float), response)
    learner.response[: len(response)] = response
    learner.advance()
    return profile(made, learner.heard - (made.law.matrix.response @ made.law.start[..., None])[..., 0])


def drawn(made: Setup, seed: int) -> np.ndarray:
    band = float(made.law.matrix.frequency[0]), float(made.law.matrix.frequency[-1])
    spectrum = LineSpectrum(made.shot.frames // 4, made.law.matrix.outputs, made.shot.rate / 4, band, made.plans)
    plant = DrawnPlant(made.law, spectrum, np.random.default_rng(seed))
    return profile(made, plant.respond(made.law.start) - (plant.response @ made.law.start[..., None])[..., 0])


def main(seeds: list[int]) -> None:
    rows: dict[str, list[np.ndarray]] = {"simulated": [], "drawn": []}
    for seed in seeds:
        settings = ("learning.law=kalman", f"simulator.options.seed={seed}")
        made = setup(
            rig_file.load(None, RigConfig, settings), identified((f"simulator.options.seed={seed}",)).matrix, False
        )
        rows["simulated"].append(simulated(made, seed))
        rows["drawn"].append(drawn(made, seed))
    print("from Hz  " + " ".join(f"{edge:6d}" for edge in EDGES[:-1]))
    for name, values in rows.items():
        for what, level in (("median", np.median(values, axis=0)), ("spread", np.std(values, axis=0))):
            print(f"{name}, {what:7}" + " ".join(f"{each:6.1f}" for each in level))


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or list(SEEDS))
