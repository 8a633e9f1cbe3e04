"""How fast each learning law gets there, on ten seeds of every kind of simulated vibrator.

`python -m benchmarks.learning_seeds [LAW] [SEED ...]`, a minute or two a seed; prints a line a run and then the
table of `docs/learning.md`.  Every machine is measured by the product's own calibration, then it learns `SHOTS` shots
of the default reference, without audio; a run whose next drive would break the guard's limits ends there.
"""

import json
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from calibration.experiment import RawFolder
from calibration.vibrator import Calibration, calibrate
from firmware_sim.laboratory import plant_block
from rigkit import config as rig_file
from tests.shared_data import DATA, MEASURED_PAIRS, measured_pair
from vibractl.config import RigConfig
from vibractl.guard import violation
from vibractl.quality import Judge, holds_from
from vibractl.setup import Setup, setup
from vibractl.transfer_matrix import TransferMatrix

SEEDS = range(1, 11)
FEWER = 3
"""Seeds of what is in front of a measured pair."""
SHOTS = 30
EARLY = 5
"""The shot by which an early IAE is read."""
LONGEST = 10.0
"""s of drive that a plant is prepared for."""
TREND, SHOT = 0.02, 5.6
"""Of all modal frequencies over the whole run; s, how long a shot lasts."""
ARRAY = (
    "simulator.plant=vibrator-array",
    "audio.drive_channels=[1, 2, 3, 4]",
    "audio.response_channels=[1, 2, 3, 4]",
    "audio.loopback_output=5",
    "audio.loopback_input=5",
)
LAWS = {"kalman": (), "stretch": ("adaptation.stretch=true",), "thesis": ("learning.law=thesis",)}
"""`stretch` is kalman with that part of it on."""
THE_THESIS = "thesis, its stepped sine"
"""The thesis' law after the thesis' own half hour of characterisation; on the default plant only."""


@dataclass(frozen=True)
class Plant:
    """A kind of plant: what stands in the rig file, and what changes only once it has been measured."""

    settings: tuple[str, ...] = ()
    afterwards: tuple[str, ...] = ()


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


class Emitter:
    """A plant that answers at once, and whose hydrophones nobody reads."""

    def __init__(self, config: RigConfig) -> None:
        self._block = plant_block(config.simulator.plant, dict(config.simulator.options))
        self.prepare(config.audio.rate, round(LONGEST * config.audio.rate))

    def prepare(self, rate: float, frames: int) -> None:
        self._block.prepare(rate, frames)
        self._unread = [np.zeros((frames, port.width)) for port in self._block.outputs[1:]]

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        self._block.process(drive, response, *(unread[: len(drive)] for unread in self._unread))

    def emit(self, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        emitted, response = drive.astype(np.float32), np.zeros((len(drive), self._block.outputs[0].width))
        self.process(emitted.astype(float), response)
        return emitted, response.astype(np.float32)


def plants(folder: Path) -> dict[str, Plant]:
    """Return every kind; measured pairs only where ../shared/data is, their files in `folder`."""
    drifting = tuple(f"simulator.options.{text}" for text in (f"trend={TREND}", f"trend_seconds={SHOTS * SHOT}"))
    kinds = {
        "default": Plant(),
        "trend 2 %": Plant(afterwards=drifting),
        "nonlinearity 1.6": Plant(("simulator.options.nonlinearity=1.6",)),
        "side 1 alone": Plant(afterwards=("learning.side=1",)),
        "4 x 4": Plant(ARRAY),
    }
    for name in MEASURED_PAIRS if DATA.exists() else ():
        files = json.dumps([str(file) for file in measured_pair(name, folder)])
        pair = ("simulator.plant=vibrator-impulse-response", f"simulator.options.files={files}", "shot.tail=1.0")
        kinds[name] = Plant(pair)
    return kinds


@cache
def identified(settings: tuple[str, ...]) -> Calibration:
    """Calibrate the plant of a rig file."""
    config = rig_file.load(None, RigConfig, settings)
    with tempfile.TemporaryDirectory() as folder, RawFolder(Path(folder)) as raw:
        return calibrate(config, raw, Emitter(config).emit)


@dataclass(frozen=True)
class Run:
    """What `learned` saw: IAEs (sides,) of every shot, and the rest as in `Outcome`."""

    iae: list[np.ndarray]
    shot: float
    refused: bool
    covered: float


def learned(matrix: TransferMatrix, settings: tuple[str, ...], count: int) -> Run:
    """Learn."""
    made = setup(rig_file.load(None, RigConfig, settings), matrix, fresh_plans=False)
    learner, judge, plant = made.learner(), Judge(made), Emitter(made.config)
    algorithm, active, refused = learner.algorithm, made.law.active > 0, False
    iae, over, held, bound = [], [], [], np.inf
    while len(iae) < count and not (refused := _breaks_a_limit(learner.drive, made)):
        _, learner.response[: made.shot.total] = plant.emit(learner.drive)
        error = judge.error(learner.response[: made.shot.total])
        iae.append(np.abs(error).sum(axis=0))
        over.append((np.abs(judge.lines(error)) / judge.limit)[judge.judged].max())
        learner.advance()
        left = np.linalg.norm(made.law.reference - learner.heard, axis=1)
        held.append(float(np.mean((left <= bound)[active])))
        bound = algorithm.error_bound
    first = None if refused else holds_from([level <= 1.0 for level in over])
    return Run(iae, np.inf if first is None else first, refused, float(np.mean(held[1:] or [np.nan])))


def outcome(kind: Plant, seed: int, law: tuple[str, ...], method: tuple[str, ...]) -> Outcome:
    """Measure a plant, and learn on it."""
    own = (*kind.settings, f"simulator.options.seed={seed}")
    found = identified((*own, *method))
    at_work = (*own, *kind.afterwards)
    run = learned(found.matrix, (*at_work, *law), SHOTS)
    plain = learned(found.matrix, (*at_work, *LAWS["thesis"], "learning.start=reference"), 1)
    early = np.min(run.iae[: EARLY + 1], axis=0)
    ratios = (float((start / end).min()) for start in (run.iae[0], plain.iae[0]) for end in (early, run.iae[-1]))
    return Outcome(found.seconds, run.shot, run.refused, *ratios, run.covered)


def row(plant: str, law: str, runs: list[Outcome]) -> str:
    """Return a row of the table: medians, and the worst seed in brackets."""
    shot, refused = [run.shot for run in runs], sum(run.refused for run in runs)
    never = f"{sum(map(np.isinf, shot))} of {len(runs)}" + (f", {refused} at the guard" if refused else "")
    cells = [plant, law, f"{runs[0].seconds:.0f}", _shot(float(np.median(shot))), _shot(max(shot)), never]
    for name in ("early", "end", "early_from_reference", "end_from_reference"):
        ratios = [getattr(run, name) for run in runs]
        cells.append(f"{np.median(ratios):.0f} ({min(ratios):.1f})")
    held = [100 * run.covered for run in runs if np.isfinite(run.covered)]
    cells.append(f"{np.mean(held):.1f} ({min(held):.1f})" if held else "")
    return " | ".join(["", *cells, ""]).strip()


def main(wanted: list[str], seeds: list[int]) -> None:
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, kind in plants(Path(folder)).items():
            laws = {law: (LAWS[law], ()) for law in wanted}
            if name == "default" and "thesis" in wanted:
                laws[THE_THESIS] = (LAWS["thesis"], ("characterisation.method=stepped",))
            for law, (settings, method) in laws.items():
                runs = []
                for seed in seeds[: FEWER if name in MEASURED_PAIRS else None]:
                    runs.append(outcome(kind, seed, settings, method))
                    print(f"{name}, {law}, seed {seed}:", runs[-1], flush=True)
                rows.append(row(name, law, runs))
    head = ["plant", "law", "identified in, s", "shot, median", "worst", f"never in {SHOTS}"]
    head += [f"IAE: first / best by shot {EARLY}", "first / last", f"scaled reference / by {EARLY}", "... / last"]
    print("\n" + " | ".join(["", *head, "errors within bound, %", ""]).strip())
    print("|---" * 11 + "|", *rows, sep="\n")


def _breaks_a_limit(drive: np.ndarray, made: Setup) -> bool:
    return violation(np.asarray(drive, dtype=float), made.config.limits, made.shot.rate) is not None


def _shot(number: float) -> str:
    return "never" if np.isinf(number) else f"{number:g}"


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:] if text not in LAWS]
    main([text for text in sys.argv[1:] if text in LAWS] or list(LAWS), numbers or list(SEEDS))
