"""What a shot was in lines, in a file beside its recording: gains, certificates, error, and the hum between."""

from pathlib import Path

import numpy as np

from rigkit.sealed_file import opened, sealed, whole
from vibractl.learner import Learner
from vibractl.mains import Hum

_SUFFIX = ".h5"
_FREQUENCY, _AMPLITUDE, _DOUBT = "hum_frequency", "hum_amplitude", "hum_doubt"


def write_lines(recording: Path, learner: Learner) -> None:
    """Keep gain and certificate of every line, (6.12)/(6.18), and the hum, of the shot that was learned from last."""
    algorithm, law, hum = learner.algorithm, learner.algorithm.law, learner.hum
    values: list[tuple[str, str, np.ndarray | float]] = [
        ("frequency", "Hz", law.matrix.frequency),
        ("gain", "1", algorithm.daring.gain),
        ("certificate", "1", algorithm.daring.certificate),
        ("error_bound", "m/s^2 s", algorithm.daring.error_bound),
        ("error", "m/s^2 s", law.reference - learner.heard),
    ]
    if hum is not None:
        values += [(_FREQUENCY, "Hz", hum.frequency), (_AMPLITUDE, "m/s^2", hum.amplitude)]
        values += [(_DOUBT, "(m/s^2)^2", hum.doubt)]
    with sealed(recording.with_suffix(_SUFFIX)) as file:
        for name, unit, value in values:
            file.create_dataset(name, data=value).attrs["unit"] = unit


def read_hum(recording: Path) -> Hum | None:
    """Return the hum that was taken out of a shot; None where none was."""
    path = recording.with_suffix(_SUFFIX)
    if not path.exists():
        return None
    with opened(path) as file:
        if _FREQUENCY not in file:
            return None
        return Hum(float(file[_FREQUENCY][()]), whole(file[_AMPLITUDE]), whole(file[_DOUBT]))
