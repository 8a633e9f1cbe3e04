"""The stage behind its link as a bench: what is repeated, given up and refused."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from calibration.__main__ import main
from calibration.stage_axes import live_bench
from calibration.stage_axes.live_bench import ATTEMPTS, LiveBench
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.link.excitation import Heard, SamplesLost
from stagectl.link.stage_link import StageLink
from stagectl.stage.piezo_pid import Pid
from stagectl.wire.messages import Drive

RIG = StageConfig()
LINK = cast(StageLink, SimpleNamespace())


def playing(monkeypatch: pytest.MonkeyPatch, spoiled: int) -> list[Any]:
    """Let the first `spoiled` excitations lose samples; return the arguments of each."""
    played: list[Any] = []

    def excited(_: StageLink, drive: Drive, axis: int, deviation: np.ndarray, *__: object) -> Heard:
        played.append((drive, axis))
        if len(played) <= spoiled:
            raise SamplesLost(f"too bad, {len(played)}")
        signals = np.outer(deviation, [1.0, 2.0, 3.0])
        return Heard(500.0 + signals, 10 + signals, 20 + signals)

    monkeypatch.setattr(live_bench, "excited", excited)
    return played


def test_a_recording_with_lost_samples_is_repeated_and_never_used(monkeypatch: pytest.MonkeyPatch) -> None:
    played, told = playing(monkeypatch, 2), list[str]()
    bench = LiveBench(RIG, 1, None, LINK, lambda: False, told.append)
    emitted, heard = bench.emit(np.array([[0.06], [0.11]]))
    np.testing.assert_allclose(emitted[:, 0], [500.1, 500.2])
    np.testing.assert_allclose(heard[0], [10.05, 10.1, 10.15, 20.05, 20.1, 20.15, 0.0, 0.0, 0.0])
    assert [drive for drive, *_ in played] == [Drive.VOLTAGE] * 3
    assert told == ["recording 1 is discarded: too bad, 1", "recording 2 is discarded: too bad, 2"]


def test_it_is_given_up_after_some_times(monkeypatch: pytest.MonkeyPatch) -> None:
    played = playing(monkeypatch, ATTEMPTS)
    with pytest.raises(SamplesLost, match=f"{ATTEMPTS} recordings had to be discarded, the last: too bad, {ATTEMPTS}"):
        LiveBench(RIG, 1, None, LINK, lambda: False, lambda _: None).emit(np.zeros((10, 1)))
    assert len(played) == ATTEMPTS


def test_with_closed_loop_its_pid_goes_to_the_stage_first(monkeypatch: pytest.MonkeyPatch) -> None:
    played, sent = playing(monkeypatch, 0), list[dict[str, np.ndarray]]()
    monkeypatch.setattr(live_bench, "upload", lambda _, parameters: sent.append(parameters))
    bench = LiveBench(RIG, 1, Pid(1.0, 2.0, 3.0, 4.0, 5.0, 6.0), LINK, lambda: False, lambda _: None)
    emitted, _ = bench.emit(np.array([[7e-9]]))
    assert played[0][0] is Drive.EXTENSION
    np.testing.assert_allclose(emitted, [[47e-6 + 5e-9]])
    np.testing.assert_array_equal(sent[0]["y.inner"], [1, 2, 3, 4, 5, 6])
    assert sent[0]["x.inner"][1] == pytest.approx(2 * np.pi * 3 / 0.065e-6)


@pytest.mark.parametrize("setting", ["stage.rate=5000", 'stage.axes=["x","y"]'])
def test_a_stage_that_is_not_the_wires_is_refused(setting: str) -> None:
    rig = rig_file.load(None, StageConfig, [setting])
    with pytest.raises(ValueError, match="must be 3 at 10000, as on the wire"):
        LiveBench(rig, 0, None, LINK, lambda: False, lambda _: None)


def test_a_stage_that_is_not_there_is_one_line_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out, channel = tmp_path / "x.h5", tmp_path / "nothing"
    arguments = ["--live", "--axis", "x", "--out", str(out), "--set", f"link.channel={channel}"]
    monkeypatch.setattr("sys.argv", ["calibrate", "stage", *arguments])
    assert main() == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "cannot open link.channel" in line
    assert list(tmp_path.iterdir()) == []
