"""What a shot was in lines, in a file beside its recording: gains, certificates, error, and the hum between."""

from pathlib import Path

import numpy as np

from rigkit.sealed_file import opened, sealed, whole
from vibractl.learner import Learner
from vibractl.mains import Hum

_FREQUENCY, _AMPLITUDE, _DOUBT = "hum_frequency", "hum_amplitude", "hum_doubt"


def lines_file(run: Path, shot: int) -> Path:
    """Return where the lines of a shot of a run folder are."""
    return run / f"shots/{shot:04d}.h5"


def write_lines(path: Path, learner: Learner) -> None:
    """Keep gain and certificate of every line, (6.12)/(6.18), of the shot that was learned from last, and its hum."""
    algorithm, law, hum = learner.algorithm, learner.algorithm.law, learner.hum
    values: list[tuple[str, str, np.ndarray | float]] = [
        ("frequency", "Hz", law.matrix.frequency),
        ("gain", "1", algorithm.daring.gain),
        ("certificate", "1", algorithm.daring.certificate),
        ("error_bound", "m/s^2 s", algorithm.daring.error_bound),
        ("error", "m/s^2 s", law.reference - learner.heard),
    ]
    if hum is not None:
        parts = (
            (_FREQUENCY, "Hz", hum.frequency),
            (_AMPLITUDE, "m/s^2", hum.amplitude),
            (_DOUBT, "(m/s^2)^2", hum.doubt),
        )
        values += parts
    with sealed(path) as file:
        for name, unit, value in values:
            file.create_dataset(name, data=value).attrs["unit"] = unit


def read_hum(path: Path) -> Hum | None:
    """Return the hum that was taken out of a shot; None where none was."""
    if not path.exists():
        return None
    with opened(path) as file:
        if _FREQUENCY not in file:
            return None
        return Hum(float(file[_FREQUENCY][()]), whole(file[_AMPLITUDE]), whole(file[_DOUBT]))
