"""Replay gives the recorded drives bit for bit, and says what other settings would have done."""

import json
from pathlib import Path

import pytest

from rigkit.foreign_stream import Signals
from rigkit.progress import told_to
from tests.vibractl.linear_rig import linear_model
from tests.vibractl.test_session import run
from vibractl.replay import replay
from vibractl.replay_command import replay_command
from vibractl.run_setup import setup_of, shot_files


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "overrides", [(), ("session.recording=csv",), ("learning.decimation=1",), ("learning.side=1",)]
)
def test_every_drive_comes_out_bit_for_bit(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 3, *overrides)
    replayed = list(replay(tmp_path / "run", setup_of(tmp_path / "run")))
    assert len(replayed) == 3
    assert all(each.identical for each in replayed)


def test_other_settings_give_other_drives_from_the_second_shot_on(tmp_path: Path) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 3)
    replayed = list(replay(tmp_path / "run", setup_of(tmp_path / "run", ("learning.gains=[0.1]",))))
    assert [each.identical for each in replayed] == [True, False, False]
    assert replayed[1].difference_db < 0


def test_a_shot_of_another_length_is_refused(tmp_path: Path) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 1)
    with pytest.raises(ValueError, match=r"0000.wav: .* samples, must be"):
        list(replay(tmp_path / "run", setup_of(tmp_path / "run", ("shot.tail=0.5",))))


def test_a_run_without_a_shot_is_refused(tmp_path: Path) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 1)
    shot_files(tmp_path / "run")[0].unlink()
    with pytest.raises(ValueError, match="no shot is recorded"):
        list(replay(tmp_path / "run", setup_of(tmp_path / "run")))


def test_recordings_are_read_block_by_block_and_progress_says_how_fast(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 3)
    monkeypatch.delattr(Signals, "whole")
    told: list[tuple[float, float, str]] = []
    with told_to(lambda *each: told.append(each)):
        replay_command(tmp_path / "run", json="-")
    assert [done for done, _, _ in told] == [0, 1, 2, 3]
    assert told[-1][1] == 3
    assert told[-1][2].startswith("shot 2: ")
    assert told[-1][2].endswith(" times real time")
    assert json.loads(capsys.readouterr().out)["times_real_time"] > 0
