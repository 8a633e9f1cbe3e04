"""How well each way of calibrating knows the vibrator at work, and how fast one learns with what it found.

`python -m benchmarks.identification [SEED ...]`, about a minute and a half a seed.  Error: of G against the
linearisation around the drive that makes the default reference (noise-free, undrifting), largest singular value,
relative.  Normalised: squared error of the elements over their stated variance, against that truth and against the
one around the calibration's own preload.  Shots: until the objective holds, with `law = "thesis", start = "inverse",
gains = [0.5]`.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.vibrator_truth import QUIET, RECORDS, linearised
from calibration.experiment import RawFolder
from calibration.vibrator import Calibration, calibrate
from calibration.vibrator_multisine import flat_design
from firmware_sim.plants.vibrator import VibratorPlant
from rigkit import config as rig_file
from tests.calibration.linear_vibrator import RATE, emitter
from vibractl.config import RigConfig
from vibractl.quality import Judge, holds_from
from vibractl.setup import setup
from vibractl.transfer_matrix import TransferMatrix, norm

METHODS = {
    "stepped sine": (),
    "multisine, 8 records": ("method=multisine",),
    "multisine, 4 records": ("method=multisine", "records=4"),
    "multisine, quiet": ("method=multisine", "quiet=true"),
    "both": ("method=both",),
}
SEEDS = range(1, 11)
BANDS = ((15, 100), (100, 200), (200, 400), (400, 650))
FIRST, LAST = 75, 3250
"""Bins of 0.2 Hz."""
FREQUENCY = np.arange(FIRST, LAST + 1) * 0.2
SHOTS = 20
LAW = ("learning.law=thesis", "learning.start=inverse", "learning.gains=[0.5]")


def found_by(method: tuple[str, ...], seed: int) -> Calibration:
    """Calibrate a fresh vibrator."""
    config = rig_file.load(None, RigConfig, [f"characterisation.{text}" for text in method])
    with tempfile.TemporaryDirectory() as folder, RawFolder(Path(folder)) as raw:
        return calibrate(config, raw, emitter(seed))


def learned(matrix: TransferMatrix, seed: int, **options: float) -> tuple[int | None, np.ndarray]:
    """Return from which shot on the objective holds, and the last drive."""
    made = setup(rig_file.load(None, RigConfig, LAW), matrix, fresh_plans=False)
    learner, judge, met = made.learner(), Judge(made), []
    plant, response = VibratorPlant(RATE, seed=seed, **options), np.zeros(learner.drive.shape)
    for _ in range(SHOTS):
        drive = np.ascontiguousarray(learner.drive, dtype=float)
        plant.run(drive, response)
        learner.response[: len(response)] = response
        met.append(judge.marks(response, drive).met)
        learner.advance()
    return holds_from(met), drive


def truth_at_work(seed: int, rough: TransferMatrix, rounds: int = 2) -> np.ndarray:
    """Linearise around the drive that is learned on the noise-free vibrator."""
    _, drive = learned(rough, seed, **QUIET)
    return linearised(seed, drive, FIRST, LAST, rounds)


def truth_at_preload(seed: int, rounds: int = 1, records: int = RECORDS) -> np.ndarray:
    """Linearise around the multisine's own preload."""
    design, _ = flat_design(RigConfig())
    drive = np.repeat(np.concatenate([design.preload[-design.run_in :], design.preload])[:, None], 2, axis=1)
    return linearised(seed, drive, FIRST, LAST, rounds, records)


def errors(matrix: TransferMatrix, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative error (lines,) and the normalised squared error (lines, outputs, inputs)."""
    at = matrix.at(np.clip(FREQUENCY, matrix.frequency[0], matrix.frequency[-1]))
    missed = at.response - truth
    return norm(missed) / norm(truth), np.abs(missed) ** 2 / at.variance


def by_band(relative: np.ndarray) -> list[float]:
    """Return the 95 % tail of each band, %."""
    return [100 * float(np.percentile(relative[(FREQUENCY >= low) & (FREQUENCY < high)], 95)) for low, high in BANDS]


def main(seeds: list[int]) -> None:
    rows: dict[str, list[list[float]]] = {name: [] for name in METHODS}
    for seed in seeds:
        found = {name: found_by(method, seed) for name, method in METHODS.items()}
        at_work = truth_at_work(seed, found["multisine, 8 records"].matrix)
        at_preload = truth_at_preload(seed)
        for name, each in found.items():
            relative, normalised = errors(each.matrix, at_work)
            _, own = errors(each.matrix, at_preload)
            shots, _ = learned(each.matrix, seed)
            rows[name].append(
                [
                    each.seconds,
                    100 * float(np.median(relative)),
                    *by_band(relative),
                    *np.percentile(normalised, [50, 95]),
                    *np.percentile(own, [50, 95]),
                    np.inf if shots is None else shots,
                    np.nan if each.loudest is None else each.loudest,
                ]
            )
            print(f"seed {seed:2d}  {name:22}", " ".join(f"{value:7.2f}" for value in rows[name][-1]), flush=True)
    print("\nmedians over the seeds; shots: median, worst\n")
    print(f"{'':22} emitted, s  error, %  95 % tails {BANDS} Hz    at work: 50, 95 %  own: 50, 95 %  shots  loudest")
    for name, values in rows.items():
        table = np.array(values)
        middle, worst = np.median(table, axis=0), table[:, 10].max()
        print(
            f"{name:22} {middle[0]:10.1f} {middle[1]:9.2f}  {'  '.join(f'{tail:6.1f}' for tail in middle[2:6])}"
            f"  {middle[6]:8.2f} {middle[7]:6.2f}  {middle[8]:8.2f} {middle[9]:6.2f}"
            f"  {middle[10]:4.1f} {worst:4.0f}  {table[:, 11].max():6.1f}"
        )


if __name__ == "__main__":
    main([int(text) for text in sys.argv[1:]] or list(SEEDS))
