"""A recording is aligned and whole, or it is thrown away and made again; the guard has the last word."""

import functools
import math
import re
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from firmware_sim.audio import SteppedStream, Stream
from firmware_sim.faults import BadSample, Drop, Fault, Slip
from firmware_sim.plant_blocks import ImpulseResponse
from rigkit.stop import Stopped
from vibractl.audio import AudioError, GuardLatched, Line, ShotAbandoned
from vibractl.audio_memory import Word
from vibractl.capture import Discarded
from vibractl.config import Audio, Limits, RigConfig, Simulator

RATE = 44_100
ROUND_TRIP = 512 + 61


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    """Two impulse responses, each to two accelerometers, that ring for 20 ms."""
    rng = np.random.default_rng(1)
    names = []
    for name in ("one", "two"):
        ring = np.exp(-np.arange(882) / 150)[:, None] * rng.standard_normal((882, 2))
        names.append(str(tmp_path / f"{name}.wav"))
        soundfile.write(names[-1], 0.02 * ring, RATE, subtype="FLOAT")
    return names


def rig(files: list[str], **audio: Any) -> RigConfig:
    return RigConfig(
        audio=Audio(**({"isolated": False} | audio)),
        simulator=Simulator(plant="impulse-response", options={"files": files}),
    )


def sweep(seconds: float = 0.4) -> np.ndarray:
    """Return two tones that start and end at rest."""
    time = np.arange(round(seconds * RATE)) / RATE
    tones = np.sin(2 * np.pi * np.array([40.0, 90.0]) * time[:, None])
    return 2.0 * tones * np.sin(np.pi * time / seconds)[:, None] ** 2


def expected(files: list[str], drive: np.ndarray) -> np.ndarray:
    plant = ImpulseResponse(files)
    plant.prepare(float(RATE), len(drive))
    response = np.empty_like(drive)
    plant.process(drive, response)
    return response


@pytest.fixture
def card(monkeypatch: pytest.MonkeyPatch) -> list[SteppedStream]:
    """Collect the simulated streams that are opened, to have faults put into them."""
    opened: list[SteppedStream] = []
    from_config = Stream.from_config

    def constructor(config: RigConfig) -> Callable[..., Stream]:
        make = functools.partial(from_config(config))

        def keep(*args: Any, **keywords: Any) -> Stream:
            opened.append(make(*args, **keywords))
            return opened[-1]

        return keep

    monkeypatch.setattr(Stream, "from_config", constructor)
    return opened


def later(stream: SteppedStream, blocks: int, kind: Callable[..., Fault], **what: Any) -> None:
    stream.card.faults.append(kind(block=stream.card.blocks + blocks, **what))


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
        with pytest.raises(ShotAbandoned, match=r"3 recordings were discarded: a sample .*; a sample .*; a sample"):
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


def test_a_latched_guard_stops_everything_until_a_person_clears_it(files: list[str]) -> None:
    limits = Limits(rms=1.5, rms_seconds=2.0)
    config = rig(files).model_copy(update={"limits": limits})
    loud = np.concatenate([1.86 * sweep(0.4)] * 8)
    discarded: list[Discarded] = []
    with Line(config, on_discard=discarded.append) as line:
        line.emit(loud)
        with pytest.raises(GuardLatched, match=r"the guard has latched: drive [12] asks for .* limits.rms is 1.5 V"):
            line.emit(loud)  # the mean of the one before is still there
        with pytest.raises(GuardLatched, match="the guard is latched: .* a person must clear it"):
            line.emit(sweep())
        with pytest.raises(ValueError, match="must be a person's name"):
            line.clear("")
        assert line.clear("Ada").limit == "rms"
        with pytest.raises(ValueError, match="after a violation"):
            line.clear("Ada")
        for _ in range(8):
            line.emit(np.zeros((RATE, 2)))
        line.emit(sweep())
    assert not discarded


def test_stop_ramps_down_and_the_line_goes_on(files: list[str], card: list[SteppedStream]) -> None:
    drive = sweep(1.0)
    played: list[np.ndarray] = []
    with Line(rig(files)) as line:
        stream = card[0]
        exchange = stream.card.exchange

        def stopping(callback: Callable[..., None]) -> None:
            exchange(callback)
            played.append(stream.card._played.copy())  # noqa: SLF001 (what the card was given)
            if len(played) == 40:
                line.stop()

        stream.card.exchange = stopping  # type: ignore[method-assign]
        with pytest.raises(Stopped):
            line.emit(drive)
        output = np.concatenate(played)[:, :2]
        assert np.abs(output).max() > 0.1
        assert np.abs(np.diff(output, axis=0)).max() * 10 * RATE < 20_000
        assert not output[-400:].any()
        assert len(played) < 50
        stream.card.exchange = exchange  # type: ignore[method-assign]
        line._memory.response.fill(7.0)  # noqa: SLF001
        stream.advance(RATE)
        assert (line._memory.response == 7.0).all()  # noqa: SLF001 (what has ended records no more)
        np.testing.assert_allclose(line.emit(drive).response, expected(files, drive), atol=2e-6)


def test_a_fault_in_the_callback_is_silence_and_one_clear_error(files: list[str], card: list[SteppedStream]) -> None:
    with Line(rig(files)) as line:
        stream = card[0]
        line._host._graph.changes.append(lambda: 1 / 0)  # type: ignore[attr-defined]  # noqa: SLF001
        with pytest.raises(AudioError, match="the audio callback failed: ZeroDivisionError: division by zero"):
            line.emit(sweep())
        assert not stream.card._played.any()  # noqa: SLF001
        assert not stream.active


def test_a_device_that_changes_its_block_size_is_a_fault(files: list[str]) -> None:
    with Line(rig(files)) as line:
        outdata = np.ones((100, 3), np.float32)
        line._host.callback(np.zeros((100, 3), np.float32), outdata, 100, None, 0)  # type: ignore[attr-defined]  # noqa: SLF001
        assert not outdata.any()
        with pytest.raises(AudioError, match="the device asks for 100 samples, must be audio.blocksize, 512"):
            line.emit(sweep())


def test_a_stream_that_ends_by_itself_is_an_error(files: list[str], card: list[SteppedStream]) -> None:
    with Line(rig(files)) as line:
        card[0].stop()
        with pytest.raises(AudioError, match="the audio stream has ended by itself"):
            line.emit(sweep())


def test_between_emissions_zeros_are_played(files: list[str], card: list[SteppedStream]) -> None:
    with Line(rig(files)) as line:
        line.emit(sweep())
        card[0].advance(512)
        assert not card[0].card._played.any()  # noqa: SLF001


def test_a_card_that_runs_by_itself_gives_the_same(files: list[str]) -> None:
    config = rig(files).model_copy(
        update={"simulator": Simulator(plant="impulse-response", speed=20.0, options={"files": files})}
    )
    with Line(config) as line:
        np.testing.assert_allclose(line.emit(sweep()).response, expected(files, sweep()), atol=2e-6)


@pytest.mark.parametrize("alignment", ["loopback", "marker"])
def test_without_a_timing_signal_the_line_does_not_open(files: list[str], alignment: str) -> None:
    silent = [str(Path(name).with_name("silent.wav")) for name in files]
    soundfile.write(silent[0], np.zeros((1, 2)), RATE, subtype="FLOAT")
    swapped = {"loopback_input": 4, "loopback_output": 3}
    config = rig(silent, alignment=alignment, **swapped)
    make = Stream.from_config(config)
    with pytest.MonkeyPatch.context() as patch:

        def unplugged(*args: Any, **keywords: Any) -> Stream:
            stream = make(*args, **keywords)
            object.__setattr__(stream.card._laboratory.wiring, "loopback_output", 40)  # noqa: SLF001
            return stream

        patch.setattr(Stream, "from_config", lambda _: unplugged)
        wanted = {
            "loopback": "no loopback signal: its quality is 0.000.*from output 3 to input 4",
            "marker": "the marker is not heard: its quality is 0.000.*drive 1 on output 1, response 1 on input 1",
        }[alignment]
        with pytest.raises(AudioError, match=wanted), Line(config):
            pass


def test_limits_beyond_the_converter_are_refused(files: list[str]) -> None:
    with pytest.raises(ValueError, match="limits.peak is 9 V, must be <= audio.output_full_scale, 8 V"):
        Line(rig(files, output_full_scale=8.0))


@pytest.mark.parametrize(
    ("audio", "reason"),
    [
        ({"stream": "firmware_sim.audio:Missing"}, "audio.stream, firmware_sim.audio:Missing: .* has no Missing"),
        ({"stream": "no_such_module:Stream"}, "audio.stream, no_such_module:Stream: there is no module no_such_module"),
        ({"device": "USB"}, "cannot open audio.device 'USB' at 44100 .* device is 'USB', must be 'simulated'"),
    ],
)
def test_a_stream_that_cannot_be_opened_is_one_clear_error(
    files: list[str], audio: dict[str, Any], reason: str
) -> None:
    with pytest.raises(AudioError, match=reason), Line(rig(files, **audio)):
        pass


def test_the_callback_allocates_nothing_of_the_size_of_a_frame(files: list[str], card: list[SteppedStream]) -> None:
    with Line(rig(files, blocksize=8192)) as line:
        line.emit(sweep())
        words = line._memory.words  # noqa: SLF001
        words[Word.REQUEST] += 1
        callback = card[0]._callback  # noqa: SLF001
        indata, outdata = np.zeros((2, 8192, 3), np.float32)
        callback(indata, outdata, 8192, None, False)
        tracemalloc.start()
        callback(indata, outdata, 8192, None, False)
        callback(indata, outdata, 8192, None, False)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 8192
        while words[Word.DONE] != words[Word.REQUEST]:
            callback(indata, outdata, 8192, None, False)
