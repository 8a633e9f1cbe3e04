"""What can be said of a run before anything is emitted: drives, head-room, certificates, shots."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vibractl.loudness import QUANTITIES
from vibractl.predict.drive import DriveNeeds, drive_needs
from vibractl.predict.learning import Forecast, forecast
from vibractl.predict.lines import REASONS, Certificates, certificates
from vibractl.setup import Setup

RUNS = 20
"""Simulated runs."""


@dataclass(frozen=True)
class Prediction:
    """A run as it may become.

    Parameters
    ----------
    made : Setup
    drives : DriveNeeds
    lines : Certificates
    shots : Forecast
    """

    made: Setup
    drives: DriveNeeds
    lines: Certificates
    shots: Forecast

    @property
    def within_limits(self) -> bool:
        """Whether no drive breaks a limit of the guard: neither those needed nor those of the simulated runs."""
        return not self.drives.violation and bool(np.all(self.drives.headroom(self.made.config.limits) >= 0))

    def figures(self) -> dict[str, Any]:
        """Return what `--json` writes; a shot that lies beyond those simulated is infinite."""
        config, lines, shots = self.made.config, self.lines, self.shots
        return {
            "rig": config.rig.name,
            "model_date": self.made.law.matrix.provenance.get("date"),
            "reference": config.reference.signal,
            "law": config.learning.law,
            "within_limits": self.within_limits,
            "violation": self.drives.violation or None,
            "coils": [self._coil(coil) for coil in range(len(self.drives.needed))],
            "learned_lines": int(lines.learned.sum()),
            "certified_lines": int(lines.certified.sum()),
            "uncertified_lines": {reason: int((lines.reason == reason).sum()) for reason in REASONS},
            "uncertified_bands": [
                {"band_hz": [low, high], "reason": reason, "bound": bound}
                for low, high, reason, bound in lines.ranges()
            ],
            "simulated_runs": len(shots.met),
            "simulated_shots": shots.shots,
            "objective_met_part": float(np.isfinite(shots.met).mean()),
            "objective_met_shot": {"median": shots.quantile(0.5), "10": shots.quantile(0.1), "90": shots.quantile(0.9)},
            "objective_met_shots": shots.met,
        }

    def _coil(self, coil: int) -> dict[str, Any]:
        drives, room = self.drives, self.drives.headroom(self.made.config.limits)
        return {
            name: {
                "unit": unit,
                "needed": drives.needed[coil, number],
                "range_10_90": [drives.low[coil, number], drives.high[coil, number]],
                "first": drives.first[coil, number],
                "learned_90": drives.learned[coil, number],
                "headroom_db": room[coil, number],
            }
            for number, (name, unit) in enumerate(QUANTITIES)
        }


def predict(made: Setup, runs: int, tell: Callable[[int], None]) -> Prediction:
    """Predict a run from its settings, model and reference; nothing is emitted.

    Parameters
    ----------
    made : Setup
    runs : int, >= 1
        Runs to simulate.
    tell : callable
        Called with the number of runs done.
    """
    shots = forecast(made, runs, tell)
    return Prediction(made, drive_needs(made, shots.drives), certificates(made), shots)
