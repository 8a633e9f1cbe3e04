"""What is exported: the right shots, on the time axis of the recording, and clear words where that cannot be."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import soundfile

from ctlblocks import recording
from rigkit.export.optional import optional
from tests.vibractl.export.exported_run import SHOTS, recorded_run
from vibractl.export.content import read_content, selected
from vibractl.run_setup import setup_of


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded_run(tmp_path_factory.mktemp("run"), "learning.side=2")


def test_the_reference_lies_where_the_shot_plays_it(run: Path) -> None:
    content, made = read_content(run), setup_of(run)
    np.testing.assert_array_equal(content.reference[made.shot.window], made.reference.signal)
    assert not content.reference[: made.shot.lead].any()
    assert not content.reference[made.shot.lead + made.shot.frames :].any()
    assert content.sides == (2,)
    assert content.reference_names == ("reference_2",)


def test_a_shot_has_its_drives_and_responses_and_no_timing_signal(run: Path) -> None:
    content = read_content(run, "1")
    record = content.shot(1)
    assert record.names == ("drive_1", "drive_2", "response_1", "response_2")
    data, _ = soundfile.read(run / "shots" / "0001.wav", dtype="float32")
    np.testing.assert_array_equal(record.data, data[:, :4])


@pytest.mark.parametrize(
    ("text", "wanted"),
    [(None, [0, 29]), ("all", list(range(30))), ("3", [3]), ("28-29, 0,0", [0, 28, 29])],
)
def test_shots_are_asked_for_by_numbers_and_ranges(text: str | None, wanted: list[int]) -> None:
    assert selected(text, 30) == wanted


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("30", "--shots asks for 30, must rise within 0 to 29"),
        ("5-2", "--shots asks for 5-2, must rise within 0 to 29"),
        ("last", "--shots is 'last', must be all, or numbers and ranges as in 0,5,10-20"),
        ("-1", "--shots is '-1', must be all"),
        ("3-", "--shots is '3-', must be all"),
        ("", "--shots is '', must be all"),
    ],
)
def test_shots_that_are_not_there_are_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=re.escape(reason)):
        selected(text, 30)


def test_a_folder_that_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is not the folder of a run: it has no config.toml"):
        read_content(tmp_path)


def test_a_shot_of_another_length_is_refused_by_name(run: Path, tmp_path: Path) -> None:
    content = read_content(run)
    whole = recording.read(run / "shots" / f"{SHOTS - 1:04d}.wav")
    recording.write(
        tmp_path / "short.wav", recording.Recording(whole.names, whole.units, whole.rate, whole.data[:-1].copy())
    )
    changed = replace(content, files={SHOTS - 1: tmp_path / "short.wav"})
    with pytest.raises(ValueError, match=r"short\.wav: 70559 samples, must be 70560"):
        changed.shot(SHOTS - 1)


def test_a_package_that_is_missing_is_named_with_how_to_get_it() -> None:
    with pytest.raises(ValueError, match=r"this format needs no_such_package.*pip install 'vibrostage\[export\]'"):
        optional("no_such_package")
