"""The table of a run's shots: a row of `qc.csv` for each, and the figures that sum them up."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from vibractl.judging import Judging
from vibractl.learning.repeatability import Floor
from vibractl.place import PREFIXES, Place
from vibractl.quality import HIDDEN, PASS, Marks, holds_from
from vibractl.setup import Setup
from vibractl.shot_file import EVIDENCE

UNDRIVEN = 200.0
"""dB of head-room, from which a coil is silent."""
_FIGURES = "iae error_db worst_line_db worst_line_hz heard_line_db hidden proven worst_band_db worst_band_hz thd_db"
BELOW, SETTLED = -6.0, 10.0
"""dB over what changes by itself, within which the worst line is where that keeps it."""
FLOOR = ("floor_db", "floor_hz", "floor_explained_db")
"""dB re the limit of a line, Hz, and dB: what is not explained of the change from shot to shot where that is most, and
what is."""
CHECK, RISE = "check", "rise"
"""Verdicts on shots at reduced level: to check a drive of the library, or on the way to the full level."""


def summary(rows: list[dict[str, str]], made: Setup | Judging | None = None) -> dict[str, Any]:
    """Return the figures that other programs read from `summary.json`.

    Parameters
    ----------
    rows : list of dicts
        Of `qc.csv`.
    made : Setup, or Judging where there is no model, optional
        The run's, for how long it was identified.

    Returns
    -------
    dict
        `shots`; `objective_met_shot`, the first from which the objective holds to the end, or None; `worst_line_db`
        of the last shot over the limit, dB; both where it is `judged`, and at all `places` where there are hydrophones;
        `iae_ratio` per side, first shot of the whole reference over last; `first_worst_line_db` of that first shot;
        `shots_over_limit`, of the whole reference, and `shots_hidden`, those of them that the ambience may explain;
        `full_level_shot`, the first of the whole reference, or None; `loudest_line_db` and `loudest_band_db`, the
        worst line and the worst band of 50 Hz of any shot, dB over the limit, and `shots_proven_over`, those in which a
        line is over it by more than the ambience may explain, all three of shots at reduced level as well;
        `floor_db` and `floor_hz`, what the model does not explain of the change from shot to shot where that is most,
        dB re the limit of a line, and `floor_explained_db`, what it explains there, None where too few shots or noise
        hide it; `reidentifications`, of bands;
        `identification_seconds`, s of signal emitted for the model and for them, None where the model does not say.
    """
    judged, prefix = rows[0].get("judged", "") if rows else "", prefix_of(rows)
    sides = [key for key in rows[0] if key.startswith(f"{prefix}iae_")] if rows else []
    worst = [_worst(row, prefix) for row in rows]
    whole = [row for row in rows if not is_reduced(row)] or rows
    probes = [row.get("purpose") == "reidentify" for row in rows]
    bands = [float(row[key]) for row in rows for key in row if key.startswith(f"{prefix}worst_band_db_")]
    figures: dict[str, Any] = {
        "shots": len(rows),
        "objective_met_shot": _met_from([row["verdict"] for row in rows]),
        "worst_line_db": worst[-1] if worst else None,
        "iae_ratio": [float(whole[0][side]) / float(whole[-1][side]) for side in sides],
        "first_worst_line_db": _worst(whole[0], prefix) if whole else None,
        "shots_over_limit": sum(_worst(row, prefix) > 0 for row in whole),
        "shots_hidden": sum(row["verdict"] == HIDDEN for row in whole),
        "full_level_shot": next((n for n, row in enumerate(rows) if not is_reduced(row)), None),
        "loudest_line_db": max(worst, default=None),
        "loudest_band_db": max(bands, default=None),
        "shots_proven_over": sum(_has_proven(row, prefix) for row in rows),
        **{key: float(rows[-1][key]) if rows and rows[-1].get(key) else None for key in FLOOR},
        "reidentifications": sum(now and not before for before, now in pairwise([False, *probes])),
        "identification_seconds": _identification_seconds(made, sum(probes)),
    }
    if judged:
        figures |= {"judged": judged, "places": {name: _reached(rows, each) for name, each in PREFIXES.items()}}
    return figures


def _met_from(verdicts: list[str]) -> int | None:
    """Return the shot from which the objective holds to the end; a hidden one counts as the last that was judged.

    None if it does not hold at the end, or has been seen to in less than half of the shots from there.
    """
    held = [False]
    for verdict in verdicts:
        held.append(held[-1] if verdict == HIDDEN else verdict == PASS)
    first = holds_from(held[1:])
    return first if first is not None and 2 * verdicts[first:].count(HIDDEN) <= len(verdicts) - first else None


def prefix_of(rows: list[dict[str, str]]) -> str:
    """Return what the columns of `qc.csv` begin with that count."""
    judged = rows[0].get("judged") if rows else None
    return next((prefix for name, prefix in PREFIXES.items() if name == judged), "")


def _reached(rows: list[dict[str, str]], prefix: str) -> dict[str, Any]:
    """Return how the objective stands at one place, whether or not it must hold there."""
    met = [_worst(row, prefix) <= 0 and not is_reduced(row) for row in rows]
    return {"objective_met_shot": holds_from(met), "worst_line_db": _worst(rows[-1], prefix)}


def _worst(row: dict[str, str], prefix: str) -> float:
    return max(float(row[key]) for key in row if key.startswith(f"{prefix}worst_line_db_"))


def _has_proven(row: dict[str, str], prefix: str) -> bool:
    return any(float(row[key]) > 0 for key in row if key.startswith(f"{prefix}proven_"))


def _identification_seconds(made: Setup | Judging | None, probes: int) -> float | None:
    if not isinstance(made, Setup) or not (seconds := made.law.matrix.provenance.get("seconds")):
        return None
    return float(seconds) + probes * made.shot.total / made.shot.rate


def is_reduced(row: Mapping[str, str]) -> bool:
    """Say whether a shot was emitted at reduced level: to check a drive of the library, or on the way to full level."""
    return row["verdict"] in (CHECK, RISE)


def floor_cells(floor: Floor | None) -> dict[str, str]:
    """Return the cells of what is not explained of the change from shot to shot, see `Repeatability.floor`."""
    told = [""] * len(FLOOR)
    if floor is not None:
        told = [f"{floor.change:.2f}", f"{floor.frequency:.6g}", f"{floor.explained:.2f}"]
    return dict(zip(FLOOR, told, strict=True))


def floor_said(figures: Mapping[str, Any]) -> tuple[str, str]:
    """Say what changes from shot to shot without being explained, and how much, from figures of `summary`.

    Nothing where that is hidden.  The machine itself is named only where the run has come as far as that lets it, and
    where the drive's own change is smaller: before, a model that is wrong or a channel that is not the model's leaves
    as much.
    """
    change, explained = figures.get("floor_db"), figures.get("floor_explained_db")
    if change is None or 2 * figures.get("shots_hidden", 0) > figures["shots"]:
        return "", ""
    size = f"{change:.1f} dB re the limit from shot to shot, most at {figures['floor_hz']:.1f} Hz"
    worst = figures["worst_line_db"]
    is_settled = worst <= 0.0 or BELOW <= worst - change <= SETTLED
    if is_settled and explained is not None and explained <= change:
        return "change of the plant", size
    return "what the model does not explain changes by", size


def reduced(purpose: str, marks: Marks) -> dict[str, str]:
    """Return the cells that are others where not the whole reference was emitted: whatever such a shot met, counts not.

    Parameters
    ----------
    purpose : str
    marks : Marks
    """
    if marks.level == 1.0:
        return {}
    if purpose == RISE:
        return {"verdict": RISE, "reason": marks.reason.removeprefix("not judged: ")}
    return {"verdict": CHECK, "reason": f"at {20 * np.log10(marks.level):.3g} dB, to check a drive of the library"}


def row_of(
    shot: int,
    purpose: str,
    gain: float,
    marks: Marks,
    told: Mapping[Place, Marks],
    evidence: Mapping[str, str],
    repeatability: float,
) -> dict[str, Any]:
    """Return a row of `qc.csv`.

    Parameters
    ----------
    shot : int
    purpose : str
    gain : float, 1
        NaN where no law of this program made the drive.
    marks : Marks
        Those that count.
    told : mapping of Place to Marks
        Those of every place.
    evidence : mapping of str to str
        For the recording's alignment.
    repeatability : float, dB
        NaN for the first shot.
    """
    row: dict[str, Any] = {"shot": shot, "purpose": purpose}
    row |= {"verdict": marks.verdict, "reason": marks.reason}
    row["gain"] = f"{gain:g}" if np.isfinite(gain) else ""
    if len(told) > 1:
        row["judged"] = next(place.name for place, each in told.items() if each is marks)
    for place, each in told.items():
        row |= {place.prefix + name: value for name, value in _sensor_cells(each).items()}
    driven = [f"{level:.2f}" if level < UNDRIVEN else "" for level in marks.headroom_db]
    row |= {f"headroom_db_{coil + 1}": level for coil, level in enumerate(driven)}
    row["repeatability_db"] = f"{repeatability:.2f}" if np.isfinite(repeatability) else ""
    return row | {name: evidence.get(name, "") for name in EVIDENCE}


def _sensor_cells(marks: Marks) -> dict[str, str]:
    """Return the cells of each sensor."""
    row: dict[str, str] = {}
    sides = range(len(marks.iae))
    for name in _FIGURES.split():
        row |= {f"{name}_{side + 1}": f"{getattr(marks, name)[side]:.6g}" for side in sides}
    for side in sides:
        row |= {f"overtone_{n + 2}_db_{side + 1}": f"{level[side]:.2f}" for n, level in enumerate(marks.overtone_db)}
        row[f"phase_mean_deg_{side + 1}"] = f"{np.degrees(marks.phase_mean[side]):.4f}"
        row[f"phase_peak_deg_{side + 1}"] = f"{np.degrees(marks.phase_peak[side]):.4f}"
    return row
