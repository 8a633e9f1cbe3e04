"""How much of the error of models from recordings is distortion: several recordings of one nonlinear vibrator.

`python -m benchmarks.recorded_scatter [--seeds 3000:3004] [--write]`; a table of `docs/validation/recordings.md`.

The vibrators are those of `recorded_models`, as they are.  Each is recorded `TIMES` times by each kind, with other
phases or other noise, and its own noise and drift other ones.  `mean`: by how much the mean of their models differs
from the true G without distortion; `scatter`: by how much one differs from that mean.  The first is what distortion
makes of G with that kind of drive, the second what a model's variance has to cover.
"""

import tempfile
from pathlib import Path

import numpy as np

from benchmarks.page_table import put, table
from benchmarks.recorded_drives import Asked, drive_of
from benchmarks.recorded_models import LONG, Bench, asked_seeds, experiment, recorded
from calibration.from_recordings import matrix_from
from firmware_sim.plants.exciter import ExciterPlant
from vibractl.transfer_matrix import TransferMatrix

SEEDS = range(3000, 3004)
TIMES = 4
KINDS = ("multisine", "sweeps", "noise")
HEAD = ("", "vibrators", "mean off the true G, %", "scatter, %", "scatter²/var", "worst")


def models(bench: Bench, kind: str, seconds: float, energy: float) -> list[TransferMatrix]:
    """Return the models of several recordings of a kind."""
    found, (coils, sensors) = [], bench.machine.widths
    for number in range(TIMES):
        asked = Asked(coils, bench.rate, seconds, bench.config.characterisation.band, bench.seed + 100 * number)
        drive = drive_of(kind, asked, energy)
        heard = np.zeros((len(drive), sensors))
        ExciterPlant(bench.exciter, bench.rate, bench.seed + 1000 * number).run(np.ascontiguousarray(drive), heard)
        with tempfile.TemporaryDirectory() as folder:
            record = recorded(Path(folder), bench, (drive, heard), "24")
            found.append(matrix_from([record], bench.config, {"date": "now"}).matrix)
    return found


def figures(bench: Bench, found: list[TransferMatrix]) -> tuple[float, float, float]:
    """Return how far their mean is off, how far they scatter, relative, and the square of that over the variance."""
    lines = np.array(sorted(set.intersection(*(set(each.frequency) for each in found))))
    places = [np.searchsorted(each.frequency, lines) for each in found]
    response = np.stack([each.response[place] for each, place in zip(found, places, strict=True)])
    variance = np.stack([each.variance[place] for each, place in zip(found, places, strict=True)]).sum(axis=(2, 3))
    mean, true = response.mean(axis=0), bench.true[np.round(lines * LONG).astype(int)]
    size = np.linalg.norm(true, axis=(1, 2))
    apart = (np.abs(response - mean) ** 2).sum(axis=(2, 3)) * TIMES / (TIMES - 1)
    off = np.linalg.norm(mean - true, axis=(1, 2)) / size
    return float(np.median(off)), float(np.median(np.sqrt(apart) / size)), float(np.median(apart / variance))


def main() -> None:
    """Measure and print the table."""
    found: dict[str, list[tuple[float, float, float]]] = {kind: [] for kind in KINDS}
    for seed in asked_seeds(SEEDS):
        bench = Bench.of(seed, linear=False)
        _, energy, seconds = experiment(bench)
        for kind, each in found.items():
            each.append(figures(bench, models(bench, kind, seconds, energy)))
            print(f"{seed} {kind}: {each[-1]}", flush=True)
    rows = []
    for kind, each in found.items():
        off, scatter, spread = np.array(each).T
        medians = f"{100 * np.median(off):.2g}", f"{100 * np.median(scatter):.2g}", f"{np.median(spread):.2g}"
        rows.append([kind, f"{len(each)}", *medians, f"{spread.max():.2g}"])
    put(table(HEAD, rows), "validation/recordings.md", "recorded scatter")


if __name__ == "__main__":
    main()
