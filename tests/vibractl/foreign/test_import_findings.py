"""What an import finds: how late responses come, by which clock, and how channels are wired, each with its error."""

from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from rigkit.run_folder import read_events, read_quality
from tests.vibractl.foreign.lab_of_recordings import ACCELERATION, VOLTS, LabOfRecordings, late, recorded_shots
from tests.vibractl.linear_rig import RATE

MODEL = ("--model", "model.h5")
IN_ONE = "response_1=1,response_2=2,monitor_1=3,monitor_2=4"


def heard(lab: LabOfRecordings, delay: float, drift: float = 0.0) -> str:
    """Write the first shot's response as it is recorded late, by another clock, with noise 20 dB below it."""
    _, response = recorded_shots()[0]
    rng = np.random.default_rng(3_000)
    noise = 0.1 * np.sqrt(np.mean(response**2)) * rng.standard_normal(response.shape)
    return lab.sound("late.wav", (late(response, delay, drift) + noise) / ACCELERATION)


@pytest.mark.sample(1)
@pytest.mark.parametrize("delay", [0.0, 573.0, 1234.37])
def test_how_late_a_response_comes_is_found_by_the_model_and_taken_out(
    recordings: LabOfRecordings, delay: float
) -> None:
    (found,) = recordings.shown("d0.wav", heard(recordings, delay), *MODEL)
    assert found["delay"] == pytest.approx(delay, abs=0.25)
    assert found["delay_error"] < 0.5
    assert found["delay_removed"] == round(delay)
    recordings.imported("d0.wav", "late.wav", *MODEL)
    kept = recording.read("RUN/shots/0000.wav").data[:, 2:]
    left = delay - round(delay)
    away = np.sqrt(np.mean((kept - late(recorded_shots()[0][1], left)) ** 2))
    assert away < 0.12 * np.sqrt(np.mean(kept**2))
    assert float(read_quality("RUN")[0]["delay"]) == pytest.approx(delay, abs=0.25)


def test_a_delay_that_is_known_is_taken_out_as_it_is_said(recordings: LabOfRecordings) -> None:
    (found,) = recordings.shown("d0.wav", heard(recordings, 600.0), "--delay", "573")
    assert found["delay_removed"] == 573


def test_without_a_model_the_response_is_judged_where_the_reference_is(recordings: LabOfRecordings) -> None:
    before = recordings.imported("d0.wav", "r0.wav")["worst_line_db"]
    recordings.sound("r0.wav", np.roll(recorded_shots()[0][1], 700, axis=0) / ACCELERATION)
    Path("RUN").rename("BEFORE")
    assert recordings.imported("d0.wav", "r0.wav")["worst_line_db"] == pytest.approx(before, abs=0.5)
    told = [each["text"] for each in read_events("RUN") if each["event"] == "remark"]
    (late,) = (text for text in told if text.startswith("the response comes "))
    assert float(late.split()[3]) == pytest.approx(700.0, abs=0.3)
    assert "without --model FILE" in late


def test_another_clock_is_refused_and_taken_out_where_that_is_asked_for(recordings: LabOfRecordings) -> None:
    file = heard(recordings, 30.4, 80.0)
    (found,) = recordings.shown("d0.wav", file, *MODEL, "--correct-clock")
    assert found["clock_ppm"] == pytest.approx(80.0, abs=5.0)
    assert abs(found["clock_ppm"] - 80.0) < 3 * found["clock_error"]
    said = recordings.import_refused("d0.wav", file, *MODEL)
    assert "late.wav: was recorded by a clock that is 8" in said
    assert "samples in a shot, must be <= 0.25; --correct-clock takes it out" in said
    recordings.imported("d0.wav", file, *MODEL, "--correct-clock")
    kept = recording.read("RUN/shots/0000.wav").data[:, 2:]
    loud = slice(15_000, 45_000)
    away = np.sqrt(np.mean((kept - recorded_shots()[0][1])[loud] ** 2, axis=0))
    assert np.all(away < 0.15 * np.sqrt(np.mean(kept[loud] ** 2, axis=0)))
    assert any("taken out of the clock: 8" in each.get("text", "") for each in read_events("RUN"))


def test_monitors_of_the_drives_tell_place_and_clock_without_a_model(recordings: LabOfRecordings) -> None:
    drive, response = recorded_shots()[0]
    rng = np.random.default_rng(3_001)
    both = np.hstack((response / ACCELERATION, 0.5 * drive / VOLTS))
    both = late(np.vstack((np.zeros((4_000, 4)), both, np.zeros((4_000, 4)))), 70.31, 50.0)
    both += 0.1 * np.sqrt(np.mean(both**2, axis=0)) * rng.standard_normal(both.shape)
    file = recordings.sound("all.wav", both)
    (found,) = recordings.shown("d0.wav", file, "--map", IN_ONE, "--correct-clock")
    middle = 4_000 + 8_820 + 22_050 - len(both) / 2
    assert RATE * found["begins_s"] == pytest.approx(12_820 + 70.31 + 50e-6 * middle, abs=0.5)
    assert found["clock_ppm"] == pytest.approx(50.0, abs=5.0)
    assert found["drives_exchanged"] is None or found["drives_exchanged"] is False
    assert "faster than the player's" in recordings.import_refused("d0.wav", file, "--map", IN_ONE)


@pytest.mark.parametrize(
    ("channels", "reason"),
    [
        ("drive_1=2,drive_2=1", "drives 1 and 2 seem to be exchanged (confidence"),
        ("drive_1=1,drive_2=-2", "drive 2 seems to be inverted against the others (confidence"),
        ("response_1=1,response_2=-2", "response 2 inverted against what the model expects, must not be: --map"),
        ("drive_1=-1,drive_2=-2", "response 1 and 2 inverted against what the model expects, must not be: --map"),
    ],
)
def test_wires_that_are_wrong_are_refused_by_the_model(recordings: LabOfRecordings, channels: str, reason: str) -> None:
    said = recordings.import_refused("d0.wav", "r0.wav", *MODEL, "--map", channels)
    assert reason in said
    assert "r0.wav: at 0.2" in said


def test_what_of_the_wires_cannot_be_told_is_said(recordings: LabOfRecordings) -> None:
    said = recordings.done(*recordings.words("d0.wav", "r0.wav", "--dry-run"))
    assert (
        "whether drives are exchanged cannot be determined (that takes a model or a reference that differs by side)"
        in said
    )
    assert "whether player and recorder share one clock cannot be determined" in said
    assert "cannot be determined" not in recordings.done(*recordings.words("d0.wav", "r0.wav", "--dry-run", *MODEL))


def test_an_inverted_response_is_warned_of_without_a_model(recordings: LabOfRecordings) -> None:
    figures = recordings.imported("d0.wav", "r0.wav", "--map", "response_1=1,response_2=-2")
    assert figures["warnings"] == ["shot 0: response 2 is inverted against the reference"]


def test_a_reference_that_differs_by_side_tells_responses_apart(recordings: LabOfRecordings) -> None:
    time = np.arange(RATE) / RATE
    sides = [np.sin(2 * np.pi * (low * time + 20 * time**2)) * np.hanning(RATE) for low in (40.0, 60.0)]
    reference = 10.0 * np.stack(sides, axis=1)
    recordings.sound("wanted.wav", reference)
    shot = np.pad(reference, ((8_820, 17_640), (0, 0)))
    recordings.sound("d0.wav", shot / 20.0)
    recordings.sound("r0.wav", shot / ACCELERATION)
    words = ("--reference", "wanted.wav")
    (found,) = recordings.shown("d0.wav", "r0.wav", *words)
    assert (found["responses_exchanged"], found["responses_confidence"]) == (False, pytest.approx(1.0, abs=0.01))
    said = recordings.import_refused("d0.wav", "r0.wav", *words, "--map", "response_1=2,response_2=1")
    assert "responses 1 and 2 seem to be exchanged (confidence" in said


def test_shots_that_are_spoiled_are_left_out_where_that_is_asked_for(recordings: LabOfRecordings) -> None:
    response = recorded_shots()[1][1].copy()
    response[20_000:20_044, 0] = 0.0
    recordings.sound("r1.wav", response / ACCELERATION)
    said = recordings.import_refused("d?.wav", "r?.wav")
    assert "r1.wav: a dropout, response 1 at 0.4535 s, 44 samples of 0, and 0 more; --skip-spoiled leaves out" in said
    assert recordings.imported("d?.wav", "r?.wav", "--skip-spoiled")["shots"] == 1
    (left,) = [each for each in read_events("RUN") if each["event"] == "discarded"]
    assert "a dropout, response 1" in left["reason"]
