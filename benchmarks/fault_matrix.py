"""Put every fault on purpose into every sensor, one after the other, and tell what is said and what it does.

`python -m benchmarks.fault_matrix vibrator|stage`: of the vibrator under both laws, a quarter of an hour; of the stage,
minutes.
"""

import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from ctlblocks import Graph
from rigkit import config as rig_file
from rigkit.experiment.part import nothing
from rigkit.experiment.runner import Conduct, remembered
from rigkit.faults import KINDS, FaultTable
from rigkit.run_folder import read_events, read_quality
from stagectl.config import StageConfig
from stagectl.daemon.stage.spoiled import sensor_names, spoiled
from stagectl.experiments.piezo.cell import RECORDING, Cell, Seen, simulated
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.setup import Setup, setup
from tests.stagectl.daemon.bench import CHOSEN
from tests.stagectl.experiments.piezo.simulated_models import write_models
from tests.vibractl.test_faults_on_purpose import learned, loudest

FAULTS = KINDS[1:]
SECONDS = 2.0
"""Of the stage's run; the fault comes in the middle, and stays."""
MIDDLE, SWING, FREQUENCY = 225e-6, 20e-6, 5.0
"""m, m and Hz of what the stage's axes follow."""


def vibrator() -> Iterator[Sequence[object]]:
    """Yield fault, sensor, law, what was said and after how many recordings, loudest drive (V) and worst line (dB)."""
    for kind in FAULTS:
        for sensor in ("response_1", "response_2", "loopback"):
            for law in ("kalman", "thesis"):
                with tempfile.TemporaryDirectory() as folder:
                    path, reason = learned(Path(folder), sensor, kind, law)
                    discards = sum(event["event"] == "discarded" for event in read_events(path))
                    rows = read_quality(path)
                    worst = [max(float(row[f"worst_line_db_{side}"]) for side in (1, 2)) for row in rows]
                    spoilt = max(worst[2:6], default=float("nan"))
                    said = reason.removeprefix(f"{discards} recordings were discarded: ").split(";")[0]
                    yield kind, sensor, law, said, discards, loudest(path), spoilt, worst[-1]


def stage() -> Iterator[Sequence[object]]:
    """Yield fault, sensor, what was said and how many ms after, voltages, their fastest change, and error."""
    with tempfile.TemporaryDirectory() as folder:
        config, made = _followed(Path(folder))
        yield "none", "-", *_spoiled(config, made, "none", "")
        for kind in FAULTS:
            for sensor in sensor_names(config):
                yield kind, sensor, *_spoiled(config, made, kind, sensor)


def _followed(folder: Path) -> tuple[StageConfig, Setup]:
    """Return what follows a sine on every axis."""
    models = write_models(folder)
    time = np.arange(round((SECONDS + 0.1) * 1000)) / 1000.0
    wanted = MIDDLE + SWING * np.sin(2 * np.pi * FREQUENCY * time)
    table = np.column_stack([time, wanted, wanted, wanted])
    np.savetxt(folder / "sine.csv", table, delimiter=",", header="time,x,y,z", comments="")
    chosen = [f"weights.{name}={values}" for name, values in CHOSEN.items()]
    asked = [f"reference.signal={folder}/sine.csv", f"session.seconds={SECONDS}", "outer.mistuning=0.0"]
    config = rig_file.load(None, StageConfig, [*chosen, *asked])
    return config, setup(config, models)


def _spoiled(config: StageConfig, made: Setup, kind: str, sensor: str) -> Sequence[object]:
    table, times = FaultTable(sensor_names(config)), made.timeline
    middle = times.begin + round(SECONDS / 2 * times.rate)

    wanted = wanted_position(config, times)
    cell = Cell(made, wanted, _as_it_is(config, table), False, {})
    part, inject = cell.part(), partial(table.inject, sensor, kind) if sensor else nothing
    rise, follow, rest = part.phases
    until = middle - times.start
    halves = replace(follow, ticks=until, end=inject), replace(follow, ticks=follow.ticks - until)
    records, _ = remembered(replace(part, phases=(rise, *halves, rest)), Conduct())
    found = cell.stage.sensors.fault
    end = times.end if found is None else found.sample
    kept, axes = records[RECORDING], config.stage.axes
    voltage, position = (kept.select([f"{name}_{axis}" for axis in axes]).data for name in ("voltage", "position"))
    said = "" if found is None else str(found).partition(" at sample")[0]
    after = float("nan") if found is None else (end - middle) * 1e3 / times.rate
    fastest = np.abs(np.diff(voltage, axis=0)).max() * times.rate / 1e3
    error = np.abs(wanted.data[middle:end] - position[middle:end]).max(initial=0.0)
    return said, after, voltage.min(), voltage.max(), fastest, 1e6 * error


def _as_it_is(config: StageConfig, table: FaultTable) -> Seen:
    """Return a stage whose sensors are spoiled, and are recorded as they would be without."""

    def seen(graph: Graph) -> dict[str, tuple[str, bool]]:
        clean: dict[str, tuple[str, bool]] = {}

        def plant(graph: Graph) -> dict[str, tuple[str, bool]]:
            clean.update(simulated(config)(graph))
            return clean

        outputs = spoiled(plant, table, config)(graph)
        return outputs | {f"kept {name}": clean[name] for name in ("position", "extension")}

    return seen


HEADS = {
    "vibrator": ("fault", "sensor", "law", "said", "recordings", "drive, V", "worst bin, dB", "afterwards, dB"),
    "stage": ("fault", "sensor", "said", "after, ms", "lowest, V", "highest, V", "fastest, V/ms", "error, um"),
}
TABLES: dict[str, Callable[[], Iterator[Sequence[object]]]] = {"vibrator": vibrator, "stage": stage}


def main(which: str) -> None:
    """Print a table."""
    print("|", " | ".join(HEADS[which]), "|")
    print("|" + " --- |" * len(HEADS[which]))
    for row in TABLES[which]():
        print("|", " | ".join(f"{cell:.4g}" if isinstance(cell, float) else str(cell) for cell in row), "|", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
