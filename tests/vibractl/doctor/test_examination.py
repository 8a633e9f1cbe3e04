"""Each fault that can be put into a rig changes the verdict that is about it, and says what to do."""

from pathlib import Path

import numpy as np
import pytest

from firmware_sim.audio import SteppedStream
from firmware_sim.faults import Drop, Slip
from tests.vibractl.doctor.doctor_rig import SIDES, grades, spoil, verdict, vibrating, wired, with_faults
from vibractl.audio import GuardLatched
from vibractl.config import Limits
from vibractl.doctor.examination import CHECKS, announcement, duration, examine

BLOCK = 512
LOOPBACK = 2
"""Column of the cable, on both sides."""


def test_a_rig_in_order_passes_every_check(tmp_path: Path) -> None:
    assert grades(wired(tmp_path)) == dict.fromkeys(CHECKS, "pass")


def test_nothing_louder_is_played_than_was_announced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    peaks = np.zeros(3)
    blocks = [0]

    def listen(played: np.ndarray, _: np.ndarray) -> None:
        np.maximum(peaks, np.abs(played).max(axis=0), out=peaks)
        blocks[0] += 1

    spoil(monkeypatch, listen)
    config = wired(tmp_path)
    examine(config)
    assert "0.285 V (30 dB under limits.peak)" in announcement(config)[0]
    assert 0.28 < 10 * peaks[0] <= 0.285
    assert 0.28 < 10 * peaks[1] <= 0.285
    assert 0.09 < peaks[2] <= 0.1
    assert blocks[0] * BLOCK / 44_100 == pytest.approx(duration(config), rel=0.03)


@pytest.mark.usefixtures("brief")
def test_two_crossed_cables_are_named_with_the_setting_that_heals_it(tmp_path: Path) -> None:
    said = verdict(examine(wired(tmp_path, SIDES[::-1])), "channel map")
    assert said.grade == "fail"
    assert "coil 1 on response 2, coil 2 on response 1" in said.measured
    assert "audio.response_channels = [2, 1]" in said.advice


@pytest.mark.usefixtures("brief")
def test_a_side_that_hears_the_other_as_loud_is_a_warning(tmp_path: Path) -> None:
    assert grades(wired(tmp_path, np.array([[10.0, 8.0], [9.0, 10.0]])))["channel map"] == "warn"


@pytest.mark.usefixtures("brief")
@pytest.mark.sample(1)
@pytest.mark.parametrize("signs", [[[1, -1], [1, -1]], [[1, 1], [-1, -1]]], ids=["coil", "accelerometer"])
def test_an_inverted_side_is_found(tmp_path: Path, signs: list[list[int]]) -> None:
    found = examine(wired(tmp_path, SIDES * np.array(signs)))
    said = verdict(found, "polarity")
    assert said.grade == "fail"
    assert said.value == pytest.approx(-1.0, abs=1e-3)
    assert "swap the wires of coil 2 or of accelerometer 2" in said.advice
    assert verdict(found, "channel map").grade == "pass"


@pytest.mark.usefixtures("brief")
def test_a_dead_coil_and_a_dead_accelerometer_are_told_apart(tmp_path: Path) -> None:
    found = examine(wired(tmp_path, SIDES * [[1, 0], [1, 0]]))
    assert "coil 2 reaches no accelerometer" in verdict(found, "channel map").measured
    assert verdict(found, "polarity").measured.startswith("not measured")
    found = examine(wired(tmp_path, SIDES * [[1, 1], [0, 0]]))
    assert "response 2 responds to no coil" in verdict(found, "channel map").measured


@pytest.mark.usefixtures("brief")
def test_a_missing_cable_fails_and_what_needs_none_is_still_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spoil(monkeypatch, lambda _, recorded: recorded[:, LOOPBACK].fill(0.0))
    found = examine(wired(tmp_path))
    assert {each.check for each in found.verdicts if each.grade == "fail"} == {"loopback"}
    assert {each.check for each in found.verdicts if each.grade == "warn"} == {"clock", "distortion"}
    assert "put a cable from output 3 to input 3" in verdict(found, "loopback").advice
    assert verdict(found, "clock").measured == "not measured: loopback failed"


@pytest.mark.usefixtures("brief")
def test_a_cable_in_the_wrong_input_is_found_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def moved(_: np.ndarray, recorded: np.ndarray) -> None:
        recorded[:, 1] = recorded[:, LOOPBACK]
        recorded[:, LOOPBACK] = 0.0

    spoil(monkeypatch, moved)
    said = verdict(examine(wired(tmp_path)), "loopback")
    assert said.grade == "fail"
    assert said.advice == "the cable is in input 2, must be in 3"


@pytest.mark.usefixtures("brief")
@pytest.mark.sample(1)
@pytest.mark.parametrize(("gain", "grade", "words"), [(-1.0, "fail", "inverted"), (0.05, "warn", "-26.0 dB")])
def test_an_inverted_or_faint_cable_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gain: float, grade: str, words: str
) -> None:
    def scale(_: np.ndarray, recorded: np.ndarray) -> None:
        recorded[:, LOOPBACK] *= gain

    spoil(monkeypatch, scale)
    found = examine(wired(tmp_path))
    assert (verdict(found, "loopback").grade, verdict(found, "clock").grade) == (grade, "pass")
    assert words in verdict(found, "loopback").measured


def test_a_sample_repeated_every_second_is_a_clock_that_slips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = round(44_100 / BLOCK)

    def slipping(stream: SteppedStream) -> None:
        stream.card.faults += [Slip(block=150 + blocks * n, samples=1) for n in range(8)]

    with_faults(monkeypatch, slipping)
    said = verdict(examine(wired(tmp_path)), "clock")
    assert said.grade == "fail"
    assert 0.5 < said.detail["slip_samples"] < 1.1  # less where it falls into the middle of a stretch
    assert said.detail["deviation_ppm"] == pytest.approx(22.7, rel=0.2)


def test_a_block_that_is_lost_without_a_flag_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with_faults(monkeypatch, lambda stream: stream.card.faults.append(Drop(block=400, flagged=False)))
    found = examine(wired(tmp_path))
    assert (verdict(found, "clock").grade, verdict(found, "recordings").grade) == ("fail", "pass")
    assert "samples are lost" in verdict(found, "clock").advice


@pytest.mark.slow
def test_a_flagged_xrun_is_a_warning_and_one_each_time_a_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_faults(monkeypatch, lambda stream: stream.card.faults.append(Drop(block=400, flagged=True)))
    found = examine(wired(tmp_path))
    assert verdict(found, "recordings").grade == "warn"
    assert "1 of 5 discarded, 0 callbacks late: xruns" in verdict(found, "recordings").measured
    assert verdict(found, "clock").grade == "pass"
    found = examine(wired(tmp_path, attempts=1))
    assert [verdict(found, check).grade for check in ("card", "recordings", "clock")] == ["pass", "fail", "warn"]
    assert verdict(found, "clock").measured == "not measured: recordings failed"


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("hum", "mains", "grade"), [(-70.0, 50.0, "pass"), (-60.0, 50.0, "warn"), (-50.0, 60.0, "fail")]
)
def test_hum_is_judged_by_its_harmonics_above_100_hz(hum: float, mains: float, grade: str) -> None:
    """The simulated pick-up has a third harmonic 20 dB under the first; a chirp of 5 s has a line of 1.59 m/s^2 s."""
    found = examine(vibrating(hum=hum, hum_frequency=mains))
    said = verdict(found, "hum")
    assert said.grade == grade
    assert said.value == pytest.approx(hum + 4.7, abs=0.3)
    assert f"at {3 * mains:g} Hz" in said.measured
    assert verdict(found, "noise").grade == "pass"


@pytest.mark.sample(1)
@pytest.mark.parametrize(("noise", "grade"), [(-75.0, "pass"), (-30.0, "warn"), (-15.0, "fail")])
def test_noise_is_judged_as_the_lines_of_a_shot(noise: float, grade: str) -> None:
    """White noise of 10 m/s^2 rms and -x dB has lines of sqrt(5 s / 44100 Hz) of that, 1.59 m/s^2 s is 0 dB."""
    said = verdict(examine(vibrating(noise=noise)), "noise")
    assert said.grade == grade
    assert said.value == pytest.approx(noise + 20 * np.log10(10 * np.sqrt(5.4 / 44_100) / 1.58), abs=0.7)


@pytest.mark.usefixtures("brief")
@pytest.mark.sample(1)
@pytest.mark.parametrize(("cubic", "grade"), [(0.0, "pass"), (0.8, "warn"), (10.0, "fail")])
def test_a_converter_that_bends_is_found_over_the_cable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cubic: float, grade: str
) -> None:
    def bend(_: np.ndarray, recorded: np.ndarray) -> None:
        recorded[:, LOOPBACK] += cubic * recorded[:, LOOPBACK] ** 3

    spoil(monkeypatch, bend)
    found = examine(wired(tmp_path))
    assert verdict(found, "distortion").grade == grade
    assert verdict(found, "clock").grade == "pass"


def test_a_card_that_does_not_open_fails_and_the_rest_is_not_measured(tmp_path: Path) -> None:
    found = examine(wired(tmp_path, stream="firmware_sim.audio:Missing"))
    assert verdict(found, "card").grade == "fail"
    assert "has no Missing" in verdict(found, "card").measured
    assert {each.measured for each in found.verdicts[1:]} == {"not measured: card failed"}
    assert [each.check for each in found.verdicts] == list(CHECKS)


def test_a_card_that_ends_in_the_middle_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = [0]

    def gone(_: np.ndarray, __: np.ndarray) -> None:
        calls[0] += 1
        if calls[0] == 1_300:
            raise RuntimeError("unplugged")

    spoil(monkeypatch, gone)
    monkeypatch.setattr("traceback.print_exc", lambda: None)
    found = examine(wired(tmp_path))
    assert verdict(found, "card").grade == "fail"
    assert verdict(found, "loopback").grade == "pass"
    assert verdict(found, "channel map").measured == "not measured: card failed"


@pytest.mark.usefixtures("brief")
def test_without_a_cable_by_choice_the_rest_is_measured(tmp_path: Path) -> None:
    found = grades(wired(tmp_path, alignment="marker"))
    assert {check for check, grade in found.items() if grade == "warn"} == {"loopback", "clock", "distortion"}
    assert "fail" not in found.values()


@pytest.mark.slow
def test_a_guard_that_latches_is_not_made_a_verdict_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = wired(tmp_path).model_copy(update={"limits": Limits(rms=0.01, rms_seconds=10.0)})
    with pytest.raises(ValueError, match=r"the drive is not played: .*limits.rms is 0.01 V"):
        examine(config)
    monkeypatch.setattr("vibractl.audio.too_loud", lambda *_: "")
    with pytest.raises(GuardLatched):
        examine(config)
