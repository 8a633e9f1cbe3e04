"""Entries for tests, of the lines of a small run on the linear rig."""

import numpy as np

from tests.vibractl.linear_rig import linear_config, linear_matrix
from vibractl.config import RigConfig
from vibractl.library.entry import TOLD, Entry
from vibractl.library.fit import reference_hash, wiring
from vibractl.setup import setup


def entry_for(config: RigConfig | None = None, date: str = "2026-01-01T00:00:00", **tags: str) -> Entry:
    """Return an entry that fits a run with these settings: the drive that the linear plant needs."""
    config = config or linear_config()
    made = setup(config, linear_matrix())
    law = made.law
    about = dict.fromkeys(TOLD, "") | {
        "name": "kept",
        "rig": config.rig.name,
        "wiring": wiring(config),
        "reference_text": made.reference.text,
        "reference_hash": reference_hash(made.reference, config.audio.rate),
        "run": "/runs/1",
        "shot": "7",
        "date": date,
        "unit": "m/s^2",
        "met": "pass",
        "worst_line_db": "-3.00",
        "error_db": "-40.00",
    }
    drive = np.linalg.solve(law.matrix.response, law.reference[..., None])[..., 0]
    error = np.zeros_like(law.reference)
    return Entry(
        law.matrix.frequency, drive, law.reference, error, law.matrix.response, law.matrix.variance, about, tags
    )
