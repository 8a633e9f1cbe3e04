"""A short run on the linear vibrator, to be exported, and where the sets of real files lie."""

from pathlib import Path

from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.session import Session, create

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
