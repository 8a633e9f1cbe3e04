"""The guard has the last word, and whatever fails ends in silence and one clear error."""

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from firmware_sim.audio import SteppedStream, Stream
from rigkit.stop import Stopped
from tests.vibractl.audio_rig import RATE, expected, rig, sweep
from vibractl.audio import AudioError, GuardLatched, Line
from vibractl.audio_memory import Word
from vibractl.capture import Discarded
from vibractl.config import Limits, Simulator


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
        with pytest.raises(ValueError, match="is not latched"):
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
            "marker": "the marker is not detected: its quality is 0.000.*drive 1 on output 1, response 1 on input 1",
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
