"""How well an import finds delay and clock, and how fast and in how much memory it works.

`python -m benchmarks.import_timing [accuracy] [speed] [--write]`; prints the tables of `docs/validation/recordings.md`.

Accuracy: 40 draws a case, seeds from 3000.  Each draws a delay of 0 to 2000 samples with its fraction, a difference of
clocks within +-100 ppm and white noise 20 dB below each channel; a 5 s chirp is imported from a WAV file.  The delay is
that of the shot's middle, where a difference of clocks does not enter it.  `monitors`: the drive that was wanted,
against its recording; nothing but noise is between them.  `exact model`: response against the model's expectation of
the drive beside it, on a linear simulated vibrator whose model is its own.  `measured model`: the same on the simulated
vibrators as they are, nonlinear, with the model of `calibrate vibrator`: there the model errs, not the estimate.

Speed: a recording of 2 drives and 2 responses, 24 bits, imported and judged in a process of its own, with one thread.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import soundfile

from benchmarks.direct import Machine
from benchmarks.measured_pairs import identified
from benchmarks.page_table import put, table, words
from rigkit import config as rig_file
from tests.vibractl.linear_rig import QUIET, linear_matrix
from vibractl.config import RigConfig
from vibractl.foreign.import_plan import FoundShot, scan
from vibractl.foreign.near import moved
from vibractl.foreign.recorded import Scales, open_recorded
from vibractl.model_file import write_model
from vibractl.setup import Setup, setup
from vibractl.transfer_matrix import TransferMatrix

SEEDS = range(3000, 3040)
DELAY, CLOCK, NOISE = 2_000.0, 100.0, 0.1
"""Samples and ppm at most; part of a channel's rms, 20 dB."""
VIBRATORS = 4
"""Of the measured ones, each with as many draws."""
SCALES = Scales(1.0, 1.0)
SECONDS = (60, 600)


@dataclass(frozen=True)
class Machinery:
    """A vibrator's set-up and model, and one shot of it."""

    made: Setup
    matrix: TransferMatrix
    drive: np.ndarray
    response: np.ndarray


@dataclass(frozen=True)
class Draw:
    """What was drawn."""

    delay: float
    clock: float
    rng: np.random.Generator

    @classmethod
    def of(cls, seed: int) -> "Draw":
        rng = np.random.default_rng(seed)
        return cls(rng.uniform(0, DELAY), rng.uniform(-CLOCK, CLOCK), rng)

    def heard(self, signal: np.ndarray, middle: float) -> np.ndarray:
        """Return a signal as it is recorded; `middle` is the sample that comes late by the delay."""
        index = np.arange(len(signal) + round(DELAY) + 500, dtype=float)
        late = moved(signal, (index - self.delay - middle) / (1 + 1e-6 * self.clock) + middle)
        size = np.sqrt(np.mean(signal**2, axis=0))
        return late + NOISE * size * self.rng.standard_normal(late.shape)


@cache
def linear() -> Machinery:
    """Return the linear vibrator with its own model."""
    options = [f"simulator.options.{name}={value}" for name, value in QUIET.items()]
    return _machinery(rig_file.load(None, RigConfig, options), linear_matrix(20))


@cache
def measured(seed: int) -> Machinery:
    """Return a simulated vibrator as it is, with a measured model."""
    settings = (f"simulator.options.seed={seed}",)
    return _machinery(rig_file.load(None, RigConfig, settings), identified(settings).matrix)


def _machinery(config: RigConfig, matrix: TransferMatrix) -> Machinery:
    made = setup(config, matrix)
    drive, response = Machine(config).emit(made.learner().drive)
    return Machinery(made, matrix, drive.astype(float), response.astype(float))


def monitors(seed: int) -> tuple[Draw, FoundShot]:
    """Find a drive in its recording."""
    on, draw = linear(), Draw.of(seed)
    middle = on.made.shot.lead + on.made.shot.frames / 2
    return draw, _found(on, on.drive, draw.heard(np.hstack((on.response, on.drive)), middle))


def by_model(on: Machinery, seed: int) -> tuple[Draw, FoundShot]:
    """Find how late a response comes after the drive beside it."""
    draw = Draw.of(seed)
    heard = draw.heard(on.response, on.made.shot.lead + on.made.shot.frames / 2)
    return draw, _found(on, np.pad(on.drive, ((0, len(heard) - len(on.drive)), (0, 0))), heard)


def _found(on: Machinery, drive: np.ndarray, heard: np.ndarray) -> FoundShot:
    names = {f"monitor_{n}": str(2 + n) for n in (1, 2)} | {f"response_{n}": str(n) for n in (1, 2)}
    given = names if heard.shape[1] == 4 else {}
    with tempfile.TemporaryDirectory() as place:
        files = [Path(place) / "d.wav", Path(place) / "r.wav"]
        for file, data in zip(files, (drive, heard), strict=True):
            soundfile.write(file, data, 44_100, "DOUBLE")
        recorded = open_recorded(*files, on.made.config, on.made.shot, SCALES, given)
        (scanned,) = scan([recorded], on.made, on.matrix, None, lambda _: None)
    (shot,) = scanned.shots
    return shot


def place(draw: Draw, shot: FoundShot) -> tuple[float, float]:
    """Return by how much the monitors' place is wrong, and its error as it is told, samples."""
    return shot.seen.played.value - linear().made.shot.lead - draw.delay, shot.seen.played.error


def late(draw: Draw, shot: FoundShot) -> tuple[float, float]:
    """Return by how much the delay is wrong, and its error as it is told, samples."""
    assert shot.seen.late is not None
    return shot.seen.late.value - draw.delay, shot.seen.late.error


def accuracy() -> None:
    """Measure how well delay and clock are found."""
    cases: list[tuple[str, Callable[[int], tuple[Draw, FoundShot]], Callable[..., tuple[float, float]]]] = [
        ("monitors of the drives", monitors, place),
        ("response, exact model", lambda seed: by_model(linear(), seed), late),
        ("response, measured model", lambda seed: by_model(measured(1 + seed % VIBRATORS), seed), late),
    ]
    rows = []
    for name, run, delay in cases:
        found = [run(seed) for seed in SEEDS]
        off = np.array([delay(*each) for each in found])
        clock = np.array([(each.seen.clock.value - draw.clock, each.seen.clock.error) for draw, each in found])
        rows.append([name, *_told(off, 0.05), *_told(clock, 0.5)])
    delay = ["delay, rms", "largest", "told error", "within 0.05"]
    head = ["", *delay, "clock, rms", "largest", "told error", "within 0.5"]
    put(table(head, rows), "validation/recordings.md", "import accuracy")


def _told(off: np.ndarray, allowed: float) -> Iterator[str]:
    """Return rms and largest error, the median of what is told of it, and how many are within what is allowed."""
    rms = math.sqrt(float(np.mean(off[:, 0] ** 2)))
    yield f"{rms:.2g}"
    yield f"{np.abs(off[:, 0]).max():.2g}"
    yield f"{np.median(off[:, 1]):.2g}"
    yield f"{np.count_nonzero(np.abs(off[:, 0]) <= allowed)} of {len(off)}"


MEASURED = """
import json, sys, time
from vibractl.__main__ import main
import vibractl.foreign.import_command
def peak():  # of this process alone: getrusage has that of the one that started it, too
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM")) / 1024
sys.argv = json.loads(sys.argv[1])
before, began = peak(), (time.process_time(), time.perf_counter())
status = main()
print(json.dumps([status, time.process_time() - began[0], time.perf_counter() - began[1], before, peak()]))
"""


def speed() -> None:
    """Measure how fast a recording is imported and judged, and in how much memory."""
    on = measured(1)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "rig.toml").write_text(rig_file.dump(on.made.config))
        write_model(folder / "model.h5", on.matrix)
        for seconds in SECONDS:
            file = _long(folder / f"{seconds}.wav", on, seconds)
            channels = "drive_1=1,drive_2=2,response_1=3,response_2=4"
            importing = ["import", "--drive", file, "--response", file, "--map", channels, "--out"]
            for what, command in (
                ("import", [*importing, str(folder / f"plain-{seconds}")]),
                ("import --model", [*importing, str(folder / f"by-model-{seconds}"), "--model", "model.h5"]),
                ("judge", ["judge", _heard(folder, file, seconds)]),
            ):
                rows.append([f"{seconds // 60} min", f"`{what}`", *_run(folder, command, seconds)])
    speed = ["processor, times real time", "clock, times real time"]
    head = ["recording", "command", *speed, "memory above the start, MB"]
    put(table(head, rows), "validation/recordings.md", "import speed")


def _long(file: Path, on: Machinery, seconds: int) -> str:
    """Write shot after shot, drives and responses."""
    scales = on.made.config.audio.output_full_scale, on.made.config.audio.input_full_scale
    shot = np.hstack((on.drive / scales[0], on.response / scales[1]))
    with soundfile.SoundFile(file, "w", 44_100, 4, "PCM_24") as sound:
        for _ in range(int(seconds * 44_100 // len(shot))):
            sound.write(shot)
    return file.name


def _heard(folder: Path, file: str, seconds: int) -> str:
    """Write the responses alone."""
    name = f"heard-{seconds}.wav"
    with soundfile.SoundFile(folder / name, "w", 44_100, 2, "PCM_24") as sound:
        for block in soundfile.blocks(folder / file, 2**18, always_2d=True):
            sound.write(block[:, 2:])
    return name


def _run(folder: Path, command: list[str], seconds: int) -> list[str]:
    line = json.dumps(["vibractl", *command, "--config", "rig.toml"])
    surroundings = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, line], cwd=folder, env=surroundings, capture_output=True, text=True, check=True
    )
    status, processor, clock, before, peak = json.loads(done.stdout.strip().splitlines()[-1])
    if status:
        raise RuntimeError(done.stderr)
    return [f"{seconds / processor:.0f}", f"{seconds / clock:.0f}", f"{peak - before:.0f}"]


if __name__ == "__main__":
    asked = words() or ["accuracy", "speed"]
    for name in asked:
        {"accuracy": accuracy, "speed": speed}[name]()
