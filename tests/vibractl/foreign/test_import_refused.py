"""What no run can be made of is refused in one line: file, row or second, value, what is allowed; nothing is left."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import soundfile

from tests.vibractl.foreign.lab_of_recordings import ACCELERATION, LabOfRecordings, recorded_shots
from tests.vibractl.linear_rig import RATE

Change = Callable[[np.ndarray], np.ndarray]


def changed(data: np.ndarray, rows: slice | int, columns: slice | int, value: float) -> np.ndarray:
    """Return a copy with other values at a place."""
    copy = data.copy()
    copy[rows, columns] = value
    return copy


NOISE = np.random.default_rng(4).standard_normal((70_560, 2))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda data: data[:, :1], "r0.wav: 1 channels (channel_1), must have response_1, response_2, or be 2 alone"),
        (lambda data: data[:60_000], "r0.wav: 60000 samples, must be 70560, or more where the drive is one shot's"),
        (
            lambda data: changed(data, 12_345, 1, np.nan),
            "r0.wav: channel 'channel_2', sample 12345: nan, must be finit",
        ),
        (lambda data: data * [1, 0], "r0.wav: response 2 has one value throughout, must move: a dead channel"),
        (lambda data: NOISE[: len(data)] / 100, "r0.wav: at 0.2"),
        (lambda data: np.stack((data[:, 0], 1e-2 * NOISE[:, 0]), 1), "response 2 does not follow the drives: correl"),
        (lambda data: np.clip(data, -0.01, 0.01), "r0.wav: clipped, response "),
        (lambda data: np.clip(60 * data, -1, 1), "r0.wav: clipped, response "),
        (lambda data: changed(data, slice(30_000, 30_044), 1, 0), "a dropout, response 2 at 0.6803 s, 44 samples of 0"),
        (lambda data: changed(data, slice(30_000, 30_400), 0, data[30_000, 0]), "a dropout, response 1 at 0.6803 s"),
        (lambda data: data[::-1], "must be >= 0."),
    ],
)
def test_a_response_that_is_none(recordings: LabOfRecordings, change: Change, reason: str) -> None:
    data, _ = soundfile.read("r0.wav", always_2d=True)
    recordings.sound("r0.wav", change(data))
    assert reason in recordings.import_refused("d0.wav", "r0.wav", "--model", "model.h5")


def test_nothing_but_noise_holds_no_reference(recordings: LabOfRecordings) -> None:
    recordings.sound("d0.wav", 1e-2 * NOISE)
    recordings.sound("r0.wav", 1e-2 * NOISE[::-1])
    said = recordings.import_refused("d0.wav", "r0.wav")
    assert "r0.wav: does not hold the reference: correlation 0." in said
    assert "must be >= 0.5" in said


def test_a_recording_that_ends_with_the_reference_is_told_what_is_missing(recordings: LabOfRecordings) -> None:
    data, _ = soundfile.read("r0.wav", always_2d=True)
    for name in ("d0.wav", "r0.wav"):
        recordings.sound(name, data[: round(0.9 * RATE)])
    said = recordings.import_refused("d0.wav", "r0.wav")
    assert f"r0.wav: {round(0.9 * RATE)} samples, must be at least " in said
    assert "after it in which the vibrator comes to rest" in said


def test_a_drive_of_something_else_does_not_belong_to_a_response(recordings: LabOfRecordings) -> None:
    time = np.arange(70_560) / RATE
    other = 0.05 * np.sin(2 * np.pi * 300.0 * time)[:, None] * [1, 1] * np.hanning(70_560)[:, None]
    recordings.sound("d0.wav", other)
    said = recordings.import_refused("d0.wav", "r0.wav")
    assert "r0.wav: at 0.2" in said
    assert "does not belong to d0.wav: correlation 0." in said


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (lambda whole: whole[:0], "r0.wav: "),
        (lambda whole: whole[:20], "r0.wav: "),
        (lambda whole: whole[:100_000], "r0.wav: the header says "),
        (lambda whole: whole[:24] + (8_000).to_bytes(4, "little") + whole[28:], "r0.wav: the header does not add up"),
        (lambda whole: b"time,a,b\n" + whole, "r0.wav: not a WAV file"),
    ],
)
def test_a_sound_that_is_none(recordings: LabOfRecordings, content: Callable[[bytes], bytes], reason: str) -> None:
    Path("r0.wav").write_bytes(content(Path("r0.wav").read_bytes()))
    assert reason in recordings.import_refused("d0.wav", "r0.wav")


WHOLE = 70_560
"""Samples of a shot."""


def lines(rows: int = 400) -> list[str]:
    """Return a table of a recording, by default a short one."""
    _, response = recorded_shots()[0]
    time = np.arange(rows) / RATE
    data = np.column_stack((time, np.resize(response[9_000:], (rows, 2))))
    return ["time,response_1,response_2", *(",".join(f"{value:.9g}" for value in row) for row in data)]


def replaced(row: int, column: int, text: str, rows: int = 400) -> list[str]:
    """Return that table with another cell; rows count from 1."""
    found = lines(rows)
    cells = found[row - 1].split(",")
    cells[column - 1] = text
    found[row - 1] = ",".join(cells)
    return found


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        (lambda: replaced(100, 2, "nan", WHOLE), "r0.csv: row 100, column 2"),
        (lambda: replaced(100, 3, "broken", WHOLE), "r0.csv: row 100, column 3"),
        (lambda: replaced(100, 1, replaced(99, 2, "0")[98].split(",")[0]), "row 100 "),
        (lambda: replaced(100, 1, "0.001"), "row 100 "),
        (lambda: replaced(100, 1, f"{98.9 / RATE:.9g}"), "row 100 "),
        (lambda: [*lines()[:50], *lines()[60:]], "row 51 "),
        (lambda: [*lines()[:50], lines()[50] + ",1"], "r0.csv: row 51 has 4 cells, must have 3"),
        (lambda: lines()[:1], "r0.csv: "),
    ],
)
def test_a_table_that_is_none(recordings: LabOfRecordings, rows: Callable[[], list[str]], reason: str) -> None:
    Path("r0.csv").write_text("\n".join(rows()) + "\n")
    assert reason in recordings.import_refused("d0.wav", "r0.csv")


def test_a_first_line_that_contradicts_the_column_of_time(recordings: LabOfRecordings) -> None:
    Path("r0.csv").write_text('# {"rate": 48000.0}\n' + "\n".join(lines()) + "\n")
    assert "r0.csv: " in recordings.import_refused("d0.wav", "r0.csv")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--map", "drive_1=3"), "--map has drive_1, must have drive_1, drive_2, one for each drive of the rig file"),
        (("--map", "drive_1=1,drive_2=7"), "d0.wav: no channel '7'; there are 1 channel_1, 2 channel_2"),
        (("--map", "coil=1"), "--map has 'coil=1', must be drive_N, response_N or monitor_N, and =CHANNEL"),
        (("--map", "drive_1=1,drive_2=1"), "--map has 'drive_2=1', but drive_2 or that channel is there already"),
        (("--reference", "chirp:40:90:2"), "d0.wav: 70560 samples, must be at least"),
        (("--set", "audio.rate=48000"), "d0.wav: 44100 samples/s, must be audio.rate, 48000: nothing is resampled"),
        (("--set", "audio.far_field_channels=[4]"), "audio.far_field_channels is [4], must be []"),
        (("--model", "r0.wav"), "r0.wav: "),
        (("--silence", "gone.wav"), "gone.wav: there is no such file"),
        (("--dry-run",), "--out RUN/ says where it goes, --dry-run that it goes nowhere: must be one of them"),
        (("r0.wav",), "r0.wav is one file too many: quote the pattern"),
    ],
)
def test_what_is_asked_for_and_cannot_be(recordings: LabOfRecordings, words: tuple[str, ...], reason: str) -> None:
    response = recordings.sound("longer.wav", np.zeros((80_000, 2))) if "--reference" in words else "r0.wav"
    assert reason in recordings.import_refused("d0.wav", response, *words)


def test_a_folder_that_is_in_use_is_left_as_it_is(recordings: LabOfRecordings) -> None:
    Path("RUN").mkdir()
    Path("RUN/thesis.txt").write_text("years of work")
    assert (
        "RUN/ is in use: it holds thesis.txt"
        in recordings.call(*recordings.words("d0.wav", "r0.wav", "--out", "RUN"))[1]
    )
    assert [each.name for each in Path("RUN").iterdir()] == ["thesis.txt"]


def test_drives_and_responses_of_unequal_lengths_and_several_shots(recordings: LabOfRecordings) -> None:
    drive, response = recorded_shots()[0]
    recordings.sound("many.wav", np.tile(drive, (4, 1)) / 10.0)
    recordings.sound("fewer.wav", np.tile(response, (4, 1))[:-1] / ACCELERATION)
    said = recordings.import_refused("many.wav", "fewer.wav")
    assert "fewer.wav: 282239 samples, must be 282240: many.wav has as many, sample by sample beside it" in said
