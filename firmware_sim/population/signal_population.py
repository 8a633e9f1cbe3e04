"""The population of signals for identification, and the files that a record and its truth become."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from firmware_sim.population.draw import Draw, Population, Quantity
from firmware_sim.population.signal_config import SignalConfig
from firmware_sim.population.signals import Record, signal
from firmware_sim.population.systems import SYSTEMS
from rigkit import atomic
from rigkit.json_text import json_text


def draw_signal(family: str, seed: int) -> Draw:
    """Draw a system, how it is excited and what spoils the record."""
    source = signal(family, seed)
    keys = {"signal.seed": seed, "signal.family": family, "signal.samples": source.samples}
    widths = {each.name: each.value for each in source.quantities}
    columns = [
        Quantity(f"columns of {side}", ",".join(_names(letter, widths[side])), "")
        for letter, side in (("u", "inputs"), ("y", "outputs"))
    ]
    return Draw("signal", family, seed, (*source.quantities, *columns), keys)


def write_record(draw: Draw, config: SignalConfig, out: Path) -> list[Path]:
    """Write a record and its truth, and return the files.

    `out` is a CSV or WAV file, beside which the truth stands under the same name as JSON; anything else is a folder for
    record.csv and truth.json, made if it is absent.

    Raises
    ------
    ValueError : samples are missing, which a WAV file cannot say.
    """
    record = signal(draw.family, draw.seed).record(config.signal.samples)
    if out.suffix not in (".csv", ".wav"):
        out.mkdir(parents=True, exist_ok=True)
    file = out if out.suffix in (".csv", ".wav") else out / "record.csv"
    beside = out.with_suffix(".json") if file is out else out / "truth.json"
    if file.suffix == ".csv":
        atomic.write(file, table(record))
    else:
        if any("missing" in name for name in record.mixed):
            raise ValueError(f"{file}: samples are missing in this record, must be a CSV file or a folder")
        signals = np.concatenate([record.given, record.measured], axis=1)
        names = channel_names(record)
        recording.write(file, Recording(names, ("1",) * len(names), record.truth.rate, signals))
    atomic.write(beside, f"{json_text(truth(draw, record), indent=1)}\n")
    return [file, beside]


def channel_names(record: Record) -> tuple[str, ...]:
    """Return u1, u2, ..., y1, y2, ..."""
    return (*_names("u", record.given.shape[1]), *_names("y", record.measured.shape[1]))


def _names(letter: str, width: int) -> tuple[str, ...]:
    return tuple(f"{letter}{number + 1}" for number in range(width))


def table(record: Record) -> str:
    """Return a record as CSV: a row of names, then a row a sample, empty where it is missing."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(channel_names(record))
    for given, measured in zip(record.given, record.measured, strict=True):
        rows.writerow(["" if np.isnan(value) else f"{value:.12g}" for value in (*given, *measured)])
    return text.getvalue()


def truth(draw: Draw, record: Record) -> dict[str, Any]:
    """Return what is behind a record, as plain values."""
    system, names = record.truth, channel_names(record)
    return {
        "command": draw.command,
        "rate": system.rate,
        "inputs": [name for name in names if name[0] == "u"],
        "outputs": [name for name in names if name[0] == "y"],
        "order": len(system.dynamics),
        "A": _rows(system.dynamics),
        "B": _rows(system.inlet),
        "C": _rows(system.outlet),
        "D": _rows(system.direct),
        "dead_time": [int(late) for late in system.delay],
        "mixed": list(record.mixed),
        "gaps": [list(gap) for gap in record.gaps],
        "noise_rms": [float(value) for value in record.noise.std(axis=0)],
    }


def _rows(matrix: np.ndarray) -> Sequence[Sequence[float]]:
    rows: Sequence[Sequence[float]] = matrix.tolist()
    return rows


SIGNALS = Population("signal", tuple(SYSTEMS), draw_signal, write=write_record)
