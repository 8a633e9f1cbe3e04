"""A short run on the linear vibrator, to be exported, and where the sets of real files lie."""

from pathlib import Path

import numpy as np

from ctlblocks import recording
from ctlblocks.recording import Recording
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.export.content import Content
from vibractl.run_setup import create
from vibractl.session import Session

SHOTS = 3
REAL = Path(__file__).parents[3] / "shared" / "data"
"""Files of other programs; tests that read them are skipped where they are not."""


def recorded_run(folder: Path, *overrides: str) -> Path:
    """Make a run of three shots of a chirp, a second long, and return its folder."""
    run, made = create(folder / "run", linear_config(*overrides), linear_model(folder))
    with run:
        session = Session(run, made)
        session.run(SHOTS, lambda *_: None, lambda: False)
        session.summary()
    return run.path


def with_pressure(content: Content, folder: Path) -> dict[int, Path]:
    """Write shot 0 again with a hydrophone beside the accelerometers, and return it as the files of a run."""
    shot = content.shot(0)
    names, units = (*shot.names, "far_field_1"), (*shot.units, "Pa")
    data = np.column_stack((shot.data, shot.data[:, -1]))
    recording.write(folder / "0000.wav", Recording(names, units, shot.rate, data))
    return {0: folder / "0000.wav"}
