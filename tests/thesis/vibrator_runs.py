"""Models and runs of the default simulated vibrator for the published figures."""

from pathlib import Path

from calibration.experiment import RawFolder
from calibration.output import provenance
from calibration.vibrator import LiveLine, calibrate
from rigkit import config as rig_file
from rigkit.provenance import now
from rigkit.run_folder import read_quality
from rigkit.stop import StopRequest
from vibractl.audio import AudioError
from vibractl.config import RigConfig
from vibractl.model_file import write_model
from vibractl.quality_table import summary
from vibractl.run_setup import create
from vibractl.session import Session


def measured_model(folder: Path, *overrides: str) -> Path:
    """Measure the simulated vibrator's transfer matrix and return its model file."""
    config = rig_file.load(None, RigConfig, ("audio.isolated=false", "characterisation.method=stepped", *overrides))
    with RawFolder(folder / "raw") as raw, LiveLine(config, raw, StopRequest()) as line:
        matrix = calibrate(config, raw, line.emit, provenance(config, now(), {})).matrix
    write_model(folder / "model.h5", matrix)
    return folder / "model.h5"


def learned(folder: Path, model: Path, shots: int, *overrides: str) -> list[dict[str, str]]:
    """Run so many shots and return the rows of `qc.csv`; fewer where the guard's limits ended it."""
    config = rig_file.load(None, RigConfig, ("audio.isolated=false", "learning.law=thesis", *overrides))
    run, made = create(folder, config, model)
    with run:
        try:
            Session(run, made).run(shots, lambda *_: None, lambda: False)
        except (ValueError, AudioError) as fault:
            if "limits" not in str(fault):
                raise
    return read_quality(folder)


def met(rows: list[dict[str, str]]) -> int | None:
    """Return the shot from which the objective holds to the end."""
    shot: int | None = summary(rows)["objective_met_shot"]
    return shot


def worst(rows: list[dict[str, str]], shot: int) -> float:
    """Return the worst line of a shot over the limit, dB, of all sides."""
    return max(float(rows[shot][key]) for key in rows[shot] if key.startswith("worst_line_db_"))
