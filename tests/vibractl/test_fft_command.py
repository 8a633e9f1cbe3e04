"""`vibractl plan-ffts`: it measures what runs then take, is stopped at any moment, and says what is in its way."""

import json
import os
import signal
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from tests.vibractl.linear_rig import linear_model
from vibractl import fft_command
from vibractl.__main__ import main
from vibractl.fft_measurement import measured
from vibractl.fft_plans import Plans, user_wisdom
from vibractl.fft_transform import Transform
from vibractl.run_setup import WISDOM

REFERENCE = "chirp:40:90:0.2"


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def vibractl(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["vibractl", *map(str, words)])
    return main()


@pytest.mark.slow
def test_later_runs_go_by_the_plans_that_it_measures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    settings = ["--reference", REFERENCE, "--set", "learning.side=1"]
    assert vibractl(monkeypatch, "plan-ffts", *settings, "--json", tmp_path / "out.json") == 0
    shown = capsys.readouterr()
    assert "measuring FFT plans 100 %" in shown.err
    assert f"2 FFT plans are stored in {user_wisdom()}" in shown.out
    assert json.loads((tmp_path / "out.json").read_text())["plans"] == [
        {"samples": 6615, "channels": 1},
        {"samples": 26460, "channels": 1},
    ]
    stored = set(user_wisdom().read_bytes().splitlines())
    here = ["--set", "audio.isolated=false", "--model", linear_model(tmp_path), "--out", tmp_path / "run"]
    assert vibractl(monkeypatch, "run", *settings, *here, "--shots", "1") == 0
    assert set((tmp_path / "run" / WISDOM).read_bytes().splitlines()) == stored


def test_stopped_it_keeps_what_is_measured_and_goes_on_from_there(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first, begun_with = Plans(), []

    def slow(wisdom: bytes, sizes: Sequence[Transform]) -> Iterator[bytes | None]:
        begun_with.append(set(wisdom.splitlines()))
        first.planned(sizes[0])
        yield first.wisdom
        os.kill(os.getpid(), signal.SIGINT)
        while True:
            yield None

    monkeypatch.setattr(fft_command, "measured", slow)
    for _ in range(2):
        assert vibractl(monkeypatch, "plan-ffts", "--reference", "chirp:40:90:1") == 130
        assert f"1 of 2 FFT plans are stored in {user_wisdom()}; the same command" in capsys.readouterr().err
    assert begun_with[1] == set(first.wisdom.splitlines())


def test_the_process_that_measures_ends_in_the_middle_of_a_plan() -> None:
    found = measured(b"", [Transform(2_646_000, 2)])  # minutes
    assert next(found) is None
    found.close()  # joins it


def test_a_process_that_dies_is_named() -> None:
    with pytest.raises(OSError, match="the process that measures FFT plans has died, exit code 1"):
        list(measured(b"", ["no size"]))  # type: ignore[list-item]


def test_a_folder_that_cannot_be_written_is_one_line_before_anything_is_measured(
    cache: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cache.write_text("not a folder")
    monkeypatch.setattr(fft_command, "measured", lambda *_: pytest.fail("it has begun"))
    assert vibractl(monkeypatch, "plan-ffts", "--reference", REFERENCE) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert cache.read_text() == "not a folder"
