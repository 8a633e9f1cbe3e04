"""How fast each learning law gets there in front of measured impulse responses; and one run of learning, for others.

`python -m benchmarks.measured_pairs [LAW ...] [SEED ...] [--write]`, a minute or two a seed; prints a line a run and
then the table of `docs/validation/learning.md`.  Every machine is measured by the product's own calibration, then it
learns `SHOTS` shots of the default reference, without audio; a run whose next drive would break a limit of the guard
ends there.
"""

import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.direct import Machine, met, shots
from benchmarks.on_all_cores import over_seeds
from benchmarks.page_table import put, table, told, words
from calibration.experiment import RawFolder
from calibration.output import provenance
from calibration.vibrator import Calibration, calibrate
from rigkit import config as rig_file
from rigkit.provenance import now
from tests.shared_data import DATA, MEASURED_PAIRS, measured_pair
from vibractl.config import RigConfig
from vibractl.setup import setup
from vibractl.transfer_matrix import TransferMatrix

SEEDS = range(1, 4)
SHOTS = 30
EARLY = 5
"""The shot by which an early IAE is read."""
SHOT = 5.6
"""s, how long a shot lasts."""
LAWS = {
    "kalman": (),
    "steady": ("adaptation.stretch=false", "adaptation.variation=false"),
    "thesis": ("learning.law=thesis",),
}
"""`steady` is kalman without what moves in it: stretch and variation."""


@dataclass(frozen=True)
class Outcome:
    """One run.

    `seconds` of signal emitted to identify; `shot` from which the objective holds to the end, infinite if never;
    `refused`, whether the run ended at a limit of the guard; IAEs of the own first shot, and of the scaled reference
    as a drive, over the best by shot `EARLY` and over the last, on the worst side; `covered`, part of lines and shots
    whose error was within its bound.
    """

    seconds: float
    shot: float
    refused: bool
    early: float
    end: float
    early_from_reference: float
    end_from_reference: float
    covered: float


def plants(folder: Path) -> dict[str, tuple[str, ...]]:
    """Return the settings of each measured pair, their files in `folder`; none where ../shared/data is absent."""
    kinds = {}
    for name in MEASURED_PAIRS if DATA.exists() else ():
        files = json.dumps([str(file) for file in measured_pair(name, folder)])
        plant = ("simulator.plant=vibrator-impulse-response", f"simulator.options.files={files}")
        kinds[name] = (*plant, "shot.tail=1.0")
    return kinds


@cache
def identified(settings: tuple[str, ...]) -> Calibration:
    """Calibrate the plant of a rig file."""
    config = rig_file.load(None, RigConfig, settings)
    with tempfile.TemporaryDirectory() as folder, RawFolder(Path(folder)) as raw:
        return calibrate(config, raw, Machine(config).emit, provenance(config, now(), {}))


@dataclass(frozen=True)
class Run:
    """What `learned` saw: IAEs (sides,) of every shot, and the rest as in `Outcome`."""

    iae: list[np.ndarray]
    shot: float
    refused: bool
    covered: float


def learned(matrix: TransferMatrix, settings: tuple[str, ...], count: int) -> Run:
    """Learn."""
    made = setup(rig_file.load(None, RigConfig, settings), matrix)
    active = made.law.active > 0
    iae, over, held, bound = [], [], [], np.inf
    for heard in shots(made, count):
        iae.append(np.abs(heard.error).sum(axis=0))
        over.append(heard.over)
        left = np.linalg.norm(made.law.reference - heard.learner.heard, axis=1)
        held.append(float(np.mean((left <= bound)[active])))
        bound = heard.learner.algorithm.daring.error_bound
    refused = len(over) < count
    return Run(iae, np.inf if refused else met(over), refused, float(np.mean(held[1:] or [np.nan])))


def outcome(kind: tuple[str, ...], seed: int, law: tuple[str, ...]) -> Outcome:
    """Measure a plant, and learn on it."""
    own = (*kind, f"simulator.options.seed={seed}")
    found = identified(own)
    run = learned(found.matrix, (*own, *law), SHOTS)
    plain = learned(found.matrix, (*own, *LAWS["thesis"], "learning.start=reference"), 1)
    early = np.min(run.iae[: EARLY + 1], axis=0)
    ratios = (float((start / end).min()) for start in (run.iae[0], plain.iae[0]) for end in (early, run.iae[-1]))
    return Outcome(found.seconds, run.shot, run.refused, *ratios, run.covered)


def outcomes(seed: int, kind: tuple[str, ...], laws: Sequence[str]) -> dict[str, Outcome]:
    """Return the outcome of every law."""
    return {name: outcome(kind, seed, LAWS[name]) for name in laws}


def row(plant: str, law: str, runs: list[Outcome]) -> list[str]:
    """Return a row of the table: medians, and the worst seed in brackets."""
    shot, refused = [run.shot for run in runs], sum(run.refused for run in runs)
    never = f"{sum(map(np.isinf, shot))} of {len(runs)}" + (f", {refused} at the guard" if refused else "")
    cells = [plant, law, f"{runs[0].seconds:.0f}", told(float(np.median(shot))), told(max(shot)), never]
    for name in ("early", "end", "early_from_reference", "end_from_reference"):
        ratios = [getattr(run, name) for run in runs]
        cells.append(f"{np.median(ratios):.0f} ({min(ratios):.1f})")
    held = [100 * run.covered for run in runs if np.isfinite(run.covered)]
    return [*cells, f"{np.mean(held):.1f} ({min(held):.1f})" if held else ""]


def main(laws: list[str], seeds: list[int]) -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, kind in plants(Path(folder)).items():
            of_seeds = list(over_seeds(outcomes, seeds, kind=kind, laws=laws))
            for law in laws:
                runs = [of_laws[law] for of_laws in of_seeds]
                rows.append(row(name, law, runs))
                runs_told = (f"{seed}: {told(run.shot)}" for seed, run in zip(seeds, runs, strict=True))
                print(f"{name}, {law};", *runs_told, flush=True)
    head = ["plant", "law", "identified in, s", "shot, median", "worst", f"never in {SHOTS}"]
    head += [f"IAE: first / best by shot {EARLY}", "first / last", f"scaled reference / by {EARLY}", "... / last"]
    put(table([*head, "errors within bound, %"], rows), "validation/learning.md", "measured pairs")


if __name__ == "__main__":
    numbers = [int(text) for text in words() if text not in LAWS]
    main([text for text in words() if text in LAWS] or ["kalman", "thesis"], numbers or list(SEEDS))
