"""How well each way of calibrating knows the vibrator at work, and how fast one learns with what it found.

`python -m benchmarks.identification [SEED ...] [--write]`, two minutes a seed; prints the table of
`docs/validation/calibration.md`.  Error: of G against the linearisation around the drive of the default reference
(noise-free, undrifting), largest singular value, relative.  Normalised: squared error of the elements over their
stated variance, against that truth and against the one around the calibration's own preload.  Shots: until the
objective holds, with `law = "thesis", start = "inverse", gains = [0.5]`, and with the default law.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.direct import met, shots
from benchmarks.measured_pairs import identified
from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, table, words
from benchmarks.vibrator_truth import QUIET, RECORDS, linearised
from calibration.vibrator_multisine import flat_design
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.setup import setup
from vibractl.transfer_matrix import TransferMatrix, norm

METHODS = {
    "stepped sine": (),
    "multisine, 8 records": ("characterisation.method=multisine",),
    "multisine, 4 records": ("characterisation.method=multisine", "characterisation.records=4"),
    "multisine, quiet": ("characterisation.method=multisine", "characterisation.quiet=true"),
    "both": ("characterisation.method=both",),
}
SEEDS = range(1, 11)
BANDS = ((15, 100), (100, 200), (200, 400), (400, 650))
FIRST, LAST = 75, 3250
"""Bins of 0.2 Hz."""
FREQUENCY = np.arange(FIRST, LAST + 1) * 0.2
SHOTS = 20
FIXED_GAIN = ("learning.law=thesis", "learning.start=inverse", "learning.gains=[0.5]")


def learned(matrix: TransferMatrix, seed: int, *settings: str) -> tuple[float, np.ndarray]:
    """Return from which shot on the objective holds, and the last drive."""
    config = rig_file.load(None, RigConfig, (f"simulator.options.seed={seed}", *settings))
    heard = list(shots(setup(config, matrix), SHOTS))
    return met([shot.over for shot in heard]), heard[-1].drive.astype(float)


def truth_at_work(seed: int, rough: TransferMatrix, rounds: int = 2) -> np.ndarray:
    """Linearise around the drive that is learned on the noise-free vibrator."""
    quiet = (f"simulator.options.{name}={value}" for name, value in QUIET.items())
    _, drive = learned(rough, seed, *FIXED_GAIN, *quiet)
    return linearised(seed, drive, FIRST, LAST, rounds)


def truth_at_preload(seed: int, rounds: int = 1, records: int = RECORDS) -> np.ndarray:
    """Linearise around the multisine's own preload."""
    design, _ = flat_design(RigConfig())
    drive = np.repeat(np.concatenate([design.preload[-design.run_in :], design.preload]), 2, axis=1)
    return linearised(seed, drive, FIRST, LAST, rounds, records)


def errors(matrix: TransferMatrix, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative error (lines,) and the normalised squared error (lines, outputs, inputs)."""
    at = matrix.at(np.clip(FREQUENCY, matrix.frequency[0], matrix.frequency[-1]))
    missed = at.response - truth
    return norm(missed) / norm(truth), np.abs(missed) ** 2 / at.variance


def by_band(relative: np.ndarray) -> list[float]:
    """Return the 95 % tail of each band, %."""
    return [100 * float(np.percentile(relative[(FREQUENCY >= low) & (FREQUENCY < high)], 95)) for low, high in BANDS]


@dataclass(frozen=True)
class Outcome:
    """A way of calibrating on one seed.

    Signal emitted, s; error, median and 95 % tails by band, %; squared error over variance, median and 95 %, against
    the truth at work and at the own preload; shots to the objective by the fixed gain and by the default law; loudest
    line emitted, dB re the preload, where that is known.
    """

    seconds: float
    error: float
    tails: list[float]
    at_work: list[float]
    own: list[float]
    fixed: float
    default: float
    loudest: float


def of_seed(seed: int) -> dict[str, Outcome]:
    """Measure one vibrator in every way."""
    own = f"simulator.options.seed={seed}"
    found = {name: identified((own, *settings)) for name, settings in METHODS.items()}
    at_work = truth_at_work(seed, found["multisine, 8 records"].matrix)
    at_preload = truth_at_preload(seed)
    outcomes = {}
    for name, each in found.items():
        relative, normalised = errors(each.matrix, at_work)
        _, own = errors(each.matrix, at_preload)
        outcomes[name] = Outcome(
            seconds=each.seconds,
            error=100 * float(np.median(relative)),
            tails=by_band(relative),
            at_work=list(np.percentile(normalised, [50, 95])),
            own=list(np.percentile(own, [50, 95])),
            fixed=learned(each.matrix, seed, *FIXED_GAIN)[0],
            default=learned(each.matrix, seed)[0],
            loudest=np.nan if each.loudest is None else each.loudest,
        )
    return outcomes


def row(name: str, of: list[Outcome], stepped: list[Outcome]) -> list[str]:
    """Return a row of the table: medians over the seeds."""

    def middle(field: str) -> np.ndarray:
        return np.median([getattr(each, field) for each in of], axis=0)

    better = np.sum([np.less(each.tails, other.tails) for each, other in zip(of, stepped, strict=True)], axis=0)
    return [
        name,
        f"{middle('seconds'):.0f}",
        f"{middle('error'):.1f}",
        ", ".join(f"{tail:.1f}" for tail in middle("tails")),
        ", ".join(map(str, better)),
        *(", ".join(f"{value:.2f}" for value in middle(field)) for field in ("at_work", "own")),
        *(_shots([getattr(each, field) for each in of]) for field in ("fixed", "default")),
        "" if np.isnan(middle("loudest")) else f"{max(each.loudest for each in of):.1f}",
    ]


def _shots(of: list[float]) -> str:
    never = sum(map(np.isinf, of))
    known = f"{np.median(of):g} ({max(shot for shot in of if np.isfinite(shot)):g})"
    return known + (f", never {never}" if never else "")


def main(seeds: list[int]) -> None:
    of_seeds = list(over_seeds(of_seed, seeds))
    by_name = {name: [of[name] for of in of_seeds] for name in METHODS}
    head = ["", "emitted, s", "error, median, %", "95 % tails, %: to 100 Hz, to 200, to 400, to 650"]
    head += [f"seeds of {len(seeds)} on which they are below the stepped sine's"]
    head += ["error² / variance at work: median, 95 %", "... at the own preload"]
    head += ["shots, fixed gain", "... default law", "loudest line, dB"]
    rows = [row(name, of, by_name["stepped sine"]) for name, of in by_name.items()]
    put(table(head, rows), "validation/calibration.md", "identification")


if __name__ == "__main__":
    main([int(text) for text in words()] or list(SEEDS))
