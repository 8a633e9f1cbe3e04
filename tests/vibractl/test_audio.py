"""A recording is aligned and whole, or it is thrown away and made again."""

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from firmware_sim.audio import SteppedStream
from firmware_sim.faults import BadSample, Drop, Fault, Slip
from firmware_sim.plants.vibrator_array import VibratorArrayPlant
from tests.vibractl.audio_rig import RATE, ROUND_TRIP, expected, later, rig, sweep
from vibractl.audio import Line, ShotAbandoned
from vibractl.capture import Discarded
from vibractl.config import Audio, RigConfig, Simulator


@pytest.mark.parametrize("blocksize", [64, 500, 512, 2048])
def test_the_response_is_the_plants_aligned_to_the_drive(files: list[str], blocksize: int) -> None:
    drive = sweep()
    with Line(rig(files, blocksize=blocksize)) as line:
        assert line.round_trip == pytest.approx(blocksize + 61, abs=1e-6)
        for _ in range(3):
            capture = line.emit(drive)
            np.testing.assert_array_equal(capture.emitted, drive.astype(np.float32))
            np.testing.assert_allclose(capture.response, expected(files, drive), atol=2e-6)
            assert abs(capture.residual) < 1e-6
            assert capture.delay == pytest.approx(blocksize + 61, abs=1e-6)
            assert capture.quality > 0.999999
            assert (capture.input_xruns, capture.output_xruns, capture.late) == (0, 0, 0)


def test_by_marker_the_responses_of_a_session_are_aligned_to_one_another(files: list[str]) -> None:
    drive = sweep()
    with Line(rig(files, alignment="marker")) as line:
        captures = [line.emit(drive) for _ in range(2)]
        np.testing.assert_allclose(captures[0].response, captures[1].response, atol=1e-5)
        np.testing.assert_array_equal(captures[0].emitted, drive.astype(np.float32))
        offset = round(line.round_trip) - ROUND_TRIP  # what the vibrator itself delays a marker by
        assert abs(offset) < 50
        aligned = expected(files, drive)
        moved = np.roll(captures[1].response, offset, axis=0)
        np.testing.assert_allclose(moved[100:-100], aligned[100:-100], atol=1e-4 * np.abs(aligned).max())


def test_drives_and_responses_go_through_the_channels_that_the_rig_file_names(files: list[str]) -> None:
    drive = sweep()
    crossed = {"drive_channels": (5, 2), "response_channels": (3, 6), "loopback_output": 1, "loopback_input": 8}
    with Line(rig(files, **crossed)) as line:
        np.testing.assert_allclose(line.emit(drive).response, expected(files, drive), atol=2e-6)


@pytest.mark.parametrize(
    ("kind", "what", "reason"),
    [
        (Drop, {"flagged": True}, "xruns: 1 callbacks with lost input, 1 with lost output"),
        (Drop, {"flagged": False}, "the loopback signal is wrong"),
        (Slip, {"samples": 1}, "the loopback signal is wrong from"),
        (Slip, {"samples": -60}, "the loopback signal is wrong from"),
        (BadSample, {"channel": 2, "value": math.nan}, "not finite, response 2 at"),
        (BadSample, {"channel": 1, "value": -1.0}, "clipped at full scale, response 1 at"),
        (BadSample, {"channel": 3, "value": math.inf}, "not finite, loopback at"),
    ],
)
def test_a_bad_recording_is_discarded_and_made_again(
    files: list[str], card: list[SteppedStream], kind: Callable[..., Fault], what: dict[str, Any], reason: str
) -> None:
    discarded: list[Discarded] = []
    drive = sweep()
    with Line(rig(files), on_discard=discarded.append) as line:
        later(card[0], 12, kind, **what)
        if kind is Slip:  # and back again, or nothing would ever be good
            later(card[0], 35, Slip, samples=-what["samples"])
        capture = line.emit(drive)
    assert [found.attempt for found in discarded] == list(range(1, len(discarded) + 1))
    assert 1 <= len(discarded) <= 2
    assert re.search(reason, discarded[0].reason), discarded[0].reason
    assert discarded[0].capture.response.shape == drive.shape
    np.testing.assert_allclose(capture.response, expected(files, drive), atol=2e-6)


@pytest.mark.parametrize("samples", [1, -1, 40])
def test_by_marker_a_slip_in_mid_shot_is_discarded(files: list[str], card: list[SteppedStream], samples: int) -> None:
    discarded: list[Discarded] = []
    with Line(rig(files, alignment="marker"), on_discard=discarded.append) as line:
        later(card[0], 40, Slip, samples=samples)
        later(card[0], 115, Slip, samples=-samples)
        line.emit(sweep(0.5))
    assert len(discarded) == 1
    assert re.search("slip: the delay is|the marker after the drive is wrong", discarded[0].reason)


def test_a_slip_between_two_shots_is_named_with_both_delays(files: list[str], card: list[SteppedStream]) -> None:
    with Line(rig(files, attempts=2)) as line:
        line.emit(sweep())
        later(card[0], 0, Slip, samples=3)
        with pytest.raises(ShotAbandoned, match=r"2 recordings .*slip: the delay is 576\.00 samples, .* first 573\.00"):
            line.emit(sweep())


def test_the_attempts_end_with_one_error_that_gives_every_reason(files: list[str], card: list[SteppedStream]) -> None:
    discarded: list[Discarded] = []
    with Line(rig(files, attempts=3), on_discard=discarded.append) as line:
        for blocks in range(0, 200, 10):
            later(card[0], blocks, BadSample, channel=1, value=math.nan)
        with pytest.raises(ShotAbandoned, match=r"3 recordings were discarded: a sample [^;]* \(3 times\)$"):
            line.emit(sweep())
    assert [found.attempt for found in discarded] == [1, 2, 3]


def test_a_drive_that_breaks_a_limit_is_refused_before_anything_is_played(files: list[str]) -> None:
    with Line(rig(files)) as line:
        with pytest.raises(
            ValueError, match="the drive is not played: drive 2 asks for .* V at sample .*, limits.peak is 9 V"
        ):
            line.emit(sweep() * np.array([1.0, 5.0]))
        line.emit(sweep())


@pytest.mark.parametrize("shape", [(100,), (100, 1), (0, 2), (RATE + 1, 2)])
def test_a_drive_of_another_shape_or_too_long_is_refused(files: list[str], shape: tuple[int, ...]) -> None:
    with (
        Line(rig(files), seconds=1.0) as line,
        pytest.raises(ValueError, match=r"must be \(samples, 2\) with 1 to 44100 samples"),
    ):
        line.emit(np.zeros(shape))


def test_the_longest_drive_fits(files: list[str]) -> None:
    for alignment in ("loopback", "marker"):
        with Line(rig(files, alignment=alignment), seconds=0.7) as line:
            assert len(line.emit(np.zeros((round(0.7 * RATE), 2))).response) == round(0.7 * RATE)


def test_hydrophones_are_heard_in_pascal_aligned_with_the_responses() -> None:
    silent = dict.fromkeys(("noise", "hum", "far_field_noise"), -400.0)
    options = {"vibrators": 1, "hydrophones": 2, "medium": "water", "drift": 0.0, **silent}
    audio = Audio(isolated=False, far_field_channels=(6, 5), far_field_full_scale=80.0)
    drive = sweep()
    with Line(RigConfig(audio=audio, simulator=Simulator(plant="vibrator-array", options=options))) as line:
        capture = line.emit(drive)
    plant = VibratorArrayPlant(RATE, **options)
    response, far_field = np.zeros((len(drive), 2)), np.zeros((len(drive), 2))
    plant.run(drive, response, far_field)
    np.testing.assert_allclose(capture.response, response, atol=1e-4)
    np.testing.assert_allclose(capture.far_field, far_field, atol=2e-5)
    assert np.abs(far_field).max() > 1.0
