"""Figures of the thesis that follow from files which the programs have written: ratios, shot by shot, errors."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import butter, sosfiltfilt, welch

from ctlblocks.recording import read
from vibractl.model_file import read_model

RAW, TOOL, LINK = "as measured", "by the tool's deflection", "by the link's motion"
LIMIT = 40.0
"""dB that the objective is below the reference [Sörnmo 2015, sec. 6.3]."""
ROBOT, STAGE = (5.0, 35.0), (40.0, 150.0)
"""Hz: where the modes of the robot are, and those of the stage."""
DIAGONAL = 150.0
"""Hz, to which G is diagonally dominant [Sörnmo 2015, fig. 6.8]."""
BELOW = 10.0
"""Hz, to which forces are compared: all that learning looks at."""
CUTTING = 5.0
"""N: the tool is in the material where the measured force is larger."""


def clamped(stiff: str, soft: str) -> dict[str, Any]:
    """Compare stiffnesses of joints as measured, by the tool's deflection and by the link, in both clamps' JSON."""
    bolted, yielding = (_read(name) for name in (stiff, soft))
    told: dict[str, Any] = {
        "largest_backlash": 1e3 * max(each[LINK]["backlash"] for each in bolted.values()),
        "stiff_raw_least": min(each[RAW]["k_plus"] / each[LINK]["k_plus"] for each in bolted.values()),
    }
    for name, each in yielding.items():
        raw, tool = (each[way]["k_plus"] / each[LINK]["k_plus"] for way in (RAW, TOOL))
        over = each[LINK]["k_plus"] / bolted[name][LINK]["k_plus"]
        told[name] = {"raw": raw, "taken_off": (tool - raw) / (1.0 - raw), "soft_over_stiff": over}
    return told


def ratios(learned: str) -> dict[str, float]:
    """Say by how much each method's error is less after its last iteration, by `stagectl ilc`'s JSON: 1."""
    told = {}
    for method, trials in _read(learned)["methods"].items():
        told[f"method_{method}"] = trials[0]["norm"] / trials[-1]["norm"]
        told[f"reduced_{method}"] = 1.0 - trials[-1]["norm"] / trials[0]["norm"]
    return told


def shots(quality: str) -> dict[str, Any]:
    """Go through a run of the vibrator shot by shot, by its qc.csv.

    Returns
    -------
    dict
        `worst` (dB over the limit, by shot), `iae_ratio` (1, by side: shot 0 over shot 30, or the last),
        `suppression` (dB: of the last shot, below the reference), `risen` (1: the last IAE over the least, the worse
        side).
    """
    rows = _rows(quality)
    iae = _sides(rows, "iae_")
    worst = _sides(rows, "worst_line_db_").max(axis=1)
    return {
        "worst": worst,
        "iae_ratio": iae[0] / iae[min(30, len(iae) - 1)],
        "suppression": LIMIT - float(worst[-1]),
        "risen": float((iae[-1] / iae.min(axis=0)).max()),
    }


def compared(first: str, second: str) -> dict[str, float]:
    """Return the IAE of the first run's first shot over that of the second run's last one, the worse side: 1."""
    before, after = (_sides(_rows(name), "iae_") for name in (first, second))
    return {"iae_ratio": float((before[0] / after[-1]).min())}


def watched(quality: str, events: str, run: str) -> dict[str, Any]:
    """Say when a run under watch noticed a divergence and what its reidentification emitted.

    Returns
    -------
    dict
        `noticed` (shot), `loudest_chirp` (dB over the limit, of the shots that identify), `restored_after` (shots from
        the last of these until the objective holds to the end; None: it does not).
    """
    told = [json.loads(line) for line in Path(events).read_text(encoding="utf-8").splitlines()]
    found = [each["shot"] for each in told if each["event"] == "divergence"]
    rows = _rows(quality)
    identifying = [n for n, row in enumerate(rows) if row["purpose"] not in ("learn", "check")]
    worst = [_sides([rows[n]], "worst_line_db_").max() for n in identifying]
    met = _read(run)["objective_met_shot"]
    return {
        "noticed": found[0] if found else None,
        "loudest_chirp": float(max(worst)) if worst else None,
        "restored_after": max(0, met - identifying[-1]) if identifying and met is not None else None,
    }


def spectra(surface: str) -> dict[str, dict[str, float]]:
    """Look at the spectra of where the tool was in the workpiece, radially and along its axis, but for both ends.

    Returns
    -------
    dict
        By direction: `robot` and `stage`, Hz, the largest peak in the robot's and in the stage's band; `amplitude`, um,
        what the stage's band comes to as a sine.
    """
    record = read(Path(surface))
    cut = record.select([f"cut_{axis}" for axis in "xyz"]).data[len(record.data) // 10 : -len(record.data) // 10]
    told = {}
    for name, series in (("radial", np.hypot(cut[:, 1], cut[:, 2])), ("axial", cut[:, 0])):
        frequency, power = welch(series, record.rate, nperseg=8192)
        robot, stage = (np.flatnonzero((frequency >= low) & (frequency <= high)) for low, high in (ROBOT, STAGE))
        told[name] = {
            "robot": float(frequency[robot[np.argmax(power[robot])]]),
            "stage": float(frequency[stage[np.argmax(power[stage])]]),
            "amplitude": 1e6 * float(np.sqrt(2.0 * power[stage].sum() * frequency[1])),
        }
    return told


def models(loaded: str, unloaded: str) -> dict[str, float]:
    """Compare the vibrator's two model files: medians over the lines, 1.

    Returns
    -------
    dict
        `cross_low`, `cross_high`: |G21| over |G11| below 150 Hz and above; `moved`: how far G11 without preload is from
        G11 with it, over that.
    """
    found, idle = (read_model(Path(name)) for name in (loaded, unloaded))
    cross = np.abs(found.response[:, 1, 0]) / np.abs(found.response[:, 0, 0])
    low = found.frequency < DIAGONAL
    own = found.response[:, 0, 0]
    there = np.interp(idle.frequency, found.frequency, own.real) + 1j * np.interp(
        idle.frequency, found.frequency, own.imag
    )
    moved = np.abs(idle.response[:, 0, 0] - there) / np.abs(there)
    medians = (cross[low], cross[~low], moved)
    return dict(zip(("cross_low", "cross_high", "moved"), (float(np.median(each)) for each in medians), strict=True))


def force_error(estimate: str = "force.csv", sensor: str = "LEARNED/logs/milled-0/force.csv") -> dict[str, Any]:
    """Compare an estimated force with the force sensor's, where the tool cuts: rms below 10 Hz, N, by axis."""
    time, estimated = _forces(estimate)
    seen, measured = _forces(sensor)
    measured = np.stack([np.interp(time, seen, column) for column in measured.T], axis=1)
    whole = np.isfinite(estimated).all(axis=1)
    time, estimated, measured = time[whole], estimated[whole], measured[whole]
    low = butter(2, BELOW, fs=1.0 / float(np.median(np.diff(time))), output="sos")
    smooth = [sosfiltfilt(low, each, axis=0) for each in (estimated, measured)]
    cutting = np.linalg.norm(smooth[1] - smooth[1][: len(time) // 50].mean(axis=0), axis=1) > CUTTING
    rest = smooth[1][: len(time) // 50].mean(axis=0)
    rms = np.sqrt(np.mean((smooth[0] - smooth[1] + rest)[cutting] ** 2, axis=0))
    size = np.sqrt(np.mean((smooth[1] - rest)[cutting] ** 2, axis=0))
    return {name: dict(zip("xyz", map(float, each), strict=True)) for name, each in (("error", rms), ("force", size))}


def _read(name: str) -> Any:
    return json.loads(Path(name).read_text(encoding="utf-8"))


def _rows(name: str) -> list[dict[str, str]]:
    with Path(name).open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def _sides(rows: list[dict[str, str]], begin: str) -> np.ndarray:
    names = [name for name in rows[0] if name.removeprefix(begin).isdigit() and name.startswith(begin)]
    return np.array([[float(row[name]) for name in names] for row in rows])


def _forces(name: str) -> tuple[np.ndarray, np.ndarray]:
    table = np.genfromtxt(name, delimiter=",", skip_header=1)
    return table[:, 0], table[:, 1:4]
