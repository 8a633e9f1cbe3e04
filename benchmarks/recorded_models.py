"""How good models from recordings are beside the experiment's own, on the same vibrators: `calibrate vibrator --from`.

`python -m benchmarks.recorded_models [--seeds 3000:3020] [--write]`; prints tables of `docs/validation/recordings.md`.

The vibrators are those of the population, by seed, with their noise and hum.  `linear`: their distortion and drift are
taken away, and the true G is known exactly.  `as they are`: with both; the true G is still the linear one, so that
errors hold what distortion makes of G at the levels at work, the experiment's as well.  Every recording has the energy
of all drives of the experiment and lasts as long.  It goes through WAV files, whose full scale is 1.4 times the largest
sample.  Kinds: `multisine`, as many that differ as there are coils, all coils at once, each repeated; `sweeps`, coil
after coil at three levels, 6 dB apart; `noise`, independent on all coils.  `two devices`: the recorder's clock is
20 ppm faster, and `--correct-clock` is given.

The error is that of G (Frobenius) over the true |G|, its median over the lines; it is divided by the experiment's own
on the same vibrator.  `err^2/var` is the squared error over the model's variance, its median over the lines; a model's
variance has a floor, 1 % of |G|, for what depends on amplitude and no recording shows: `without the floor` is the same
over the variance that recordings show.  A recording of which no model comes does not count among the vibrators.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import soundfile

from benchmarks.page_table import put, table
from benchmarks.recorded_drives import Asked, drive_of
from calibration.experiment import Emit, RawFolder
from calibration.from_recordings import matrix_from
from calibration.multisine_estimate import FLOOR
from calibration.recorded_pair import FromRecordingsError
from calibration.recorded_signals import Recorded
from calibration.vibrator import calibrate
from firmware_sim.plants.exciter import Exciter, ExciterPlant, without_distortion
from firmware_sim.plants.mode_drift import Drift
from firmware_sim.plants.reception import silent_reception
from firmware_sim.population.machine import Machine
from firmware_sim.population.vibrators import VIBRATORS, drawn_machine
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.foreign.near import moved
from vibractl.foreign.signals import Kind, open_kind
from vibractl.transfer_matrix import TransferMatrix

SEEDS = range(3000, 3020)
SPACE = 1.4
"""Full scale of a recording over its largest sample: a recorder whose gain is set well."""
CLOCK = 20e-6
LONG, RINGS = 20.0, 10.0
"""s, of the transform of impulse responses; and time constants of the slowest decay until they have died away."""
CASES = tuple(
    (kind, bits, clock)
    for kind in ("multisine", "sweeps", "noise")
    for bits, clock in (("16", 0.0), ("24", 0.0), ("24", CLOCK))
)
NAMES = {True: "linear", False: "as they are"}
HEAD = (
    "", "vibrators", "error, %", "over the experiment's", "quartiles", "worst", "err²/var", "without the floor",
    "quartiles", "worst",
)  # fmt: skip
NOTHING = float("nan")
Run = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Judged:
    """A model against the truth: medians over its lines.

    `error` is relative; `spread` its square over the model's variance, and `bare` over that without the floor of 1 %.
    """

    error: float
    spread: float
    bare: float

    @classmethod
    def of(cls, matrix: TransferMatrix, true: np.ndarray) -> "Judged":
        """Judge it by the true G, (lines, sensors, coils), every 1 / `LONG` Hz."""
        there = true[np.round(matrix.frequency * LONG).astype(int)]
        off = (np.abs(matrix.response - there) ** 2).sum(axis=(1, 2))
        relative = np.sqrt(off / (np.abs(there) ** 2).sum(axis=(1, 2)))
        variance = matrix.variance.sum(axis=(1, 2))
        bare = variance - FLOOR**2 * (np.abs(matrix.response) ** 2).sum(axis=(1, 2))
        return cls(*(float(np.median(each)) for each in (relative, off / variance, off / bare)))


@dataclass(frozen=True)
class Bench:
    """A vibrator with its rig file."""

    machine: Machine
    config: RigConfig
    exciter: Exciter
    true: np.ndarray
    seed: int

    @classmethod
    def of(cls, seed: int, linear: bool) -> "Bench":
        draw = VIBRATORS.draw(seed, VIBRATORS.family(seed, ""))
        keys = [f"{key}={_toml(value)}" for key, value in draw.keys.items()]
        machine = drawn_machine(draw.family, seed)
        assert isinstance(machine.build, partial)
        whole: Exciter = machine.build.args[0]
        still = np.zeros(len(whole.coils.factor))
        coils = replace(whole.coils, offset=still, width=still, clip=0.0)
        sensors = replace(whole.reception.sensors, bend=np.zeros((machine.widths[1], 2)))
        plain = Exciter(
            whole.structure,
            coils,
            without_distortion(len(whole.elements)),
            replace(whole.reception, sensors=sensors),
            Drift(),
        )
        config = rig_file.load(None, RigConfig, keys)
        true = _true(plain, machine, float(config.audio.rate))
        return cls(machine, config, plain if linear else whole, true, seed)

    @property
    def rate(self) -> float:
        """Samples/s."""
        return float(self.config.audio.rate)

    def plant(self) -> Run:
        """Return the vibrator at rest, which goes on from call to call."""
        plant = ExciterPlant(self.exciter, self.rate, self.seed)

        def run(drive: np.ndarray) -> np.ndarray:
            heard = np.zeros((len(drive), self.machine.widths[1]))
            plant.run(np.ascontiguousarray(drive, float), heard)
            return heard

        return run


def _true(plain: Exciter, machine: Machine, rate: float) -> np.ndarray:
    """Return G by the impulse responses of a vibrator without distortion, noise and drift, every 1 / `LONG` Hz."""
    silent = replace(plain, reception=silent_reception(plain.reception.sensors))
    samples, columns, widths = round(min(RINGS * machine.rings + 1, LONG) * rate), [], machine.widths
    for coil in range(widths[0]):
        drive, heard = np.zeros((samples, widths[0])), np.zeros((samples, widths[1]))
        drive[0, coil] = 1.0
        ExciterPlant(silent, rate, 0).run(drive, heard)
        columns.append(np.fft.rfft(heard, round(LONG * rate), axis=0)[: round(700 * LONG)])
    return np.stack(columns, axis=2)


def _toml(value: object) -> str:
    return str(value).replace("'", '"') if isinstance(value, list) else str(value)


def experiment(bench: Bench) -> tuple[Judged, float, float]:
    """Measure by the program's own experiment; return the error, all its drives' energy, V^2 s, and how long it was."""
    run, energy, seconds = bench.plant(), 0.0, 0.0

    def emit(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nonlocal energy, seconds
        emitted = drive.astype(np.float32)
        if drive.any():
            energy += float((drive**2).sum()) / bench.rate
            seconds += len(drive) / bench.rate
        return emitted, run(emitted.astype(float)).astype(np.float32)

    called: Emit = emit
    with tempfile.TemporaryDirectory() as folder, RawFolder(Path(folder)) as raw:
        found = calibrate(bench.config, raw, called, {"date": "now"})
    return Judged.of(found.matrix, bench.true), energy, seconds


def recordings(kind: str, bench: Bench, seconds: float, energy: float) -> Iterator[Judged]:
    """Judge the models of a kind's recordings, in the order of `CASES`."""
    widths, band = bench.machine.widths, bench.config.characterisation.band
    drive = drive_of(kind, Asked(widths[0], bench.rate, seconds, band, bench.seed), energy)
    heard = bench.plant()(drive)
    for _, bits, clock in (case for case in CASES if case[0] == kind):
        place = np.arange(len(heard)) / (1 + clock)
        kept = moved(heard, place) if clock else heard
        with tempfile.TemporaryDirectory() as folder:
            record = recorded(Path(folder), bench, (drive, kept), bits)
            try:
                found = matrix_from([record], bench.config, {"date": "now"}, clock != 0)
            except FromRecordingsError as fault:
                print(f"{bench.seed}, {_name(kind, bits, clock)}: {fault}")
                yield Judged(NOTHING, NOTHING, NOTHING)
                continue
        yield Judged.of(found.matrix, bench.true)


def recorded(folder: Path, bench: Bench, signals: tuple[np.ndarray, np.ndarray], bits: str) -> Recorded:
    """Write drives and responses to WAV files, and open these."""
    opened = []
    for name, unit, data in zip(("drive", "response"), ("V", "m/s^2"), signals, strict=True):
        kind = Kind(name, data.shape[1], unit, SPACE * float(np.abs(data).max()))
        file = folder / f"{name}.wav"
        soundfile.write(file, data / kind.full_scale, round(bench.rate), f"PCM_{bits}")
        opened.append(open_kind(file, kind, bench.rate))
    return Recorded(*opened)


def measured(seed: int, linear: bool) -> list[Judged]:
    """Return the experiment's figures and those of each of `CASES` on one vibrator."""
    bench = Bench.of(seed, linear)
    own, energy, seconds = experiment(bench)
    found = [own]
    for kind in dict.fromkeys(case[0] for case in CASES):
        found += recordings(kind, bench, seconds, energy)
    return found


def rows(found: list[list[Judged]]) -> list[list[str]]:
    """Return the table's rows: the experiment, and each case beside it."""
    errors, spreads, bare = (
        np.array([[getattr(each, name) for each in one] for one in found]) for name in ("error", "spread", "bare")
    )
    names = ["the experiment", *(_name(*case) for case in CASES)]
    return [
        [
            name,
            f"{np.count_nonzero(np.isfinite(errors[:, place]))}",
            f"{100 * np.nanmedian(errors[:, place]):.2g}",
            *_quartiles(errors[:, place] / errors[:, 0]),
            f"{np.nanmedian(spreads[:, place]):.2g}",
            *_quartiles(bare[:, place]),
        ]
        for place, name in enumerate(names)
    ]


def _name(kind: str, bits: str, clock: float) -> str:
    return f"{kind}, {bits} bits" + (", two devices" if clock else "")


def _quartiles(values: np.ndarray) -> tuple[str, str, str]:
    low, middle, high = np.nanpercentile(values, [25, 50, 75])
    return f"{middle:.2g}", f"{low:.2g} to {high:.2g}", f"{np.nanmax(values):.2g}"


def asked_seeds(usual: range) -> range:
    """Return the seeds of `--seeds 3000:3020`, or the usual ones."""
    if "--seeds" not in sys.argv:
        return usual
    first, last = sys.argv[sys.argv.index("--seeds") + 1].split(":")
    return range(int(first), int(last))


def main() -> None:
    """Measure and print both tables."""
    found: dict[bool, list[list[Judged]]] = {True: [], False: []}
    for seed in asked_seeds(SEEDS):
        for linear, judged in found.items():
            begun = time.monotonic()
            judged.append(measured(seed, linear))
            figures = " ".join(f"{each.error:.4g}/{each.spread:.4g}/{each.bare:.4g}" for each in judged[-1])
            print(f"{seed} {NAMES[linear]} {time.monotonic() - begun:.0f} s: {figures}", flush=True)
    put(table(HEAD, rows(found[True])), "validation/recordings.md", "recorded models linear")
    put(table(HEAD, rows(found[False])), "validation/recordings.md", "recorded models as they are")


if __name__ == "__main__":
    main()
