"""The stage's reference from anybody's file: which column is which axis, at what rate, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.experiments.piezo.reference import wanted_position
from stagectl.experiments.piezo.timeline import timeline

ROWS = np.column_stack([np.arange(11) / 10, *np.linspace([1e-4, 2e-4, 3e-4], [2e-4, 2e-4, 1e-4], 11).T])


def written(path: Path, head: str, columns: list[int]) -> StageConfig:
    np.savetxt(path, ROWS[:, columns], delimiter=",", header=head, comments="")
    return rig_file.load(None, StageConfig, [f'reference.signal="{path}"', "session.seconds=2"])


@pytest.mark.parametrize(
    ("head", "columns"),
    [
        ("time,x,y,z", [0, 1, 2, 3]),
        ("t,z,x,y", [0, 3, 1, 2]),
        ("time [s],a [m],b [m],c [m]", [0, 1, 2, 3]),
    ],
)
def test_columns_are_found_by_axis_or_by_place_and_drawn_out_to_the_stages_rate(
    tmp_path: Path, head: str, columns: list[int]
) -> None:
    config = written(tmp_path / "ref.csv", head, columns)
    times = timeline(config)
    wanted = wanted_position(config, times)
    assert wanted.names == ("wanted_x", "wanted_y", "wanted_z")
    at = np.array([0.0, 0.55, 1.0, 1.5])
    there = wanted.data[times.begin + np.round(at * times.rate).astype(int)]
    expected = np.column_stack([np.interp(at, ROWS[:, 0], ROWS[:, k]) for k in (1, 2, 3)])
    np.testing.assert_allclose(there, expected, atol=1e-9)


@pytest.mark.parametrize(
    ("head", "columns", "reason"),
    [
        ("time,x,y", [0, 1, 2], "channels are x, y, must be 3, or have x, y, z among them"),
        ("x,y,z", [1, 2, 3], "does not say its rate"),
        ("time", [0], "holds nothing but time"),
        ("time,x [mm],y [mm],z [mm]", [0, 1, 2, 3], "units are mm, mm, mm, must be m"),
        ("time,x,y,z", [0, 0, 2, 3], "positions are 0 to 1 m, must be within limits.travel"),
    ],
)
def test_what_is_no_reference_is_refused(tmp_path: Path, head: str, columns: list[int], reason: str) -> None:
    config = written(tmp_path / "ref.csv", head, columns)
    with pytest.raises(ValueError, match=reason):
        wanted_position(config, timeline(config))
