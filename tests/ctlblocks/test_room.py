"""How much room a recording may take."""

from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from ctlblocks.room import bytes_of


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("suffix", ["wav", "csv"])
def test_no_recording_takes_more_than_is_said(tmp_path: Path, suffix: str, dtype: str) -> None:
    """Of numbers that are as long as numbers can be."""
    with np.errstate(over="ignore"):
        data = (np.random.default_rng(1).normal(size=(500, 3)) * -1e-30).astype(dtype)
    data[0] = -np.finfo(dtype).max
    data[1] = -np.finfo(dtype).tiny
    recording.write(tmp_path / f"x.{suffix}", Recording(("a", "b", "c"), ("m",) * 3, 44_100, data, {"rig": "x" * 500}))
    size = (tmp_path / f"x.{suffix}").stat().st_size
    assert size <= bytes_of(500, 3, dtype, suffix)
    assert size >= 0.7 * bytes_of(500, 3, dtype, suffix) - 2_000
