"""The simulated card keeps sounddevice's contract, so that nothing but a string tells it from a real one."""

import inspect
import threading
import time
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from ctlblocks.block import Block, Port
from firmware_sim.audio import CallbackAbort, CallbackStop, SteppedStream, Stream
from firmware_sim.card import CONVERTER_DELAY
from firmware_sim.faults import BadSample, Drop, Slip, Stall
from firmware_sim.laboratory import Laboratory, Wiring
from tests.until import EVER
from vibractl.config import Audio, RigConfig, Simulator


class Follow(Block):
    """Return the drive, as an acceleration."""

    inputs = (Port("drive", "V", 2),)
    outputs = (Port("response", "m/s^2", 2),)

    def process(self, drive: np.ndarray, response: np.ndarray) -> None:
        response[:] = drive


class Session:
    """A callback that counts samples into every output and keeps what it hears."""

    def __init__(self) -> None:
        self.heard: list[np.ndarray] = []
        self.flags: list[bool] = []
        self.times: list[Any] = []
        self.count = 0

    def __call__(self, indata: np.ndarray, outdata: np.ndarray, frames: int, time: Any, status: Any) -> None:
        assert indata.shape == (frames, 3)
        assert outdata.shape == (frames, 3)
        self.heard.append(indata.copy())
        self.flags.append(bool(status.input_overflow or status.output_underflow))
        self.times.append(time)
        outdata[:] = ((self.count + 1 + np.arange(frames)) / 1e6)[:, None]
        self.count += frames


def laboratory() -> Laboratory:
    return Laboratory(Follow(), Wiring(output_full_scale=1.0, input_full_scale=1.0))


def stepped(callback: Callable[..., None], blocks: int, *faults: Any, **keywords: Any) -> SteppedStream:
    stream = SteppedStream(44_100, 64, None, 3, "float32", None, None, callback, laboratory=laboratory(), **keywords)
    stream.card.faults.extend(faults)
    stream.start()
    stream.advance(64 * blocks)
    return stream


def counted(session: Session) -> np.ndarray:
    """Return which emitted sample, counted from 1, each heard sample is; 0 for silence."""
    return np.rint(np.concatenate(session.heard)[:, 2] * 1e6)


@pytest.mark.usefixtures("portaudio")
def test_the_constructor_is_sounddevices() -> None:
    import sounddevice

    theirs = list(inspect.signature(sounddevice.Stream).parameters)
    ours = inspect.signature(Stream).parameters
    assert list(ours)[: len(theirs)] == theirs
    assert all(ours[name].default is None for name in theirs)
    assert all(p.kind is inspect.Parameter.KEYWORD_ONLY for p in list(ours.values())[len(theirs) :])
    for name in ("start", "stop", "abort", "close", "active", "stopped", "closed", "time", "cpu_load"):
        assert hasattr(Stream, name) or name in vars(stepped(Session(), 0))
    for name in ("samplerate", "blocksize", "device", "channels", "dtype", "samplesize", "latency"):
        assert hasattr(stepped(Session(), 0), name)


@pytest.fixture
def portaudio() -> ModuleType:
    """Import sounddevice, or skip."""
    try:
        import sounddevice
    except OSError as fault:
        pytest.skip(str(fault))
    return sounddevice


def test_what_is_played_comes_back_after_a_block_and_the_converters() -> None:
    session = Session()
    stepped(session, 10)
    heard = counted(session)
    late = 64 + CONVERTER_DELAY
    assert not heard[:late].any()
    np.testing.assert_array_equal(heard[late:], np.arange(1, 641 - late))


def test_the_stream_is_silent_until_started_and_after_it_was_stopped() -> None:
    session, ended = Session(), []
    stream = SteppedStream(
        channels=3, callback=session, finished_callback=lambda: ended.append(1), laboratory=laboratory()
    )
    stream.advance(1000)
    assert session.count == 0
    with stream:
        assert stream.active
        assert not stream.stopped
        stream.advance(600)
        assert session.count == 1024
        assert stream.time == pytest.approx(1024 / 44_100)
    stream.advance(1000)
    assert session.count == 1024
    assert ended == [1]
    assert stream.stopped
    assert stream.closed
    with pytest.raises(ValueError, match="the stream is closed"):
        stream.start()


def test_the_output_buffer_is_handed_over_as_it_was_left() -> None:
    seen: list[float] = []

    def forgetful(_: np.ndarray, outdata: np.ndarray, *__: Any) -> None:
        seen.append(float(outdata[0, 0]))
        if len(seen) == 2:
            outdata[:] = 0.25

    stepped(forgetful, 4)
    assert seen == [0.0, 0.0, 0.25, 0.25]


@pytest.mark.parametrize("how", [CallbackStop, CallbackAbort, ZeroDivisionError])
def test_a_callback_that_raises_ends_the_stream(how: type[Exception], capsys: pytest.CaptureFixture[str]) -> None:
    calls: list[int] = []

    def raising(*_: Any) -> None:
        calls.append(1)
        if len(calls) == 3:
            raise how

    stream = stepped(raising, 10)
    assert len(calls) == 3
    assert not stream.active
    assert not stream.stopped  # as in sounddevice: it was not stopped, it ended
    assert ("ZeroDivisionError" in capsys.readouterr().err) == (how is ZeroDivisionError)


def test_sounddevices_own_stop_is_honoured(portaudio: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    def raising(*_: Any) -> None:
        raise portaudio.CallbackStop

    assert not stepped(raising, 2).active
    assert capsys.readouterr().err == ""


def test_with_a_clock_it_runs_by_itself_and_gives_the_same() -> None:
    session, ended = Session(), threading.Event()

    def callback(*exchange: Any) -> None:
        session(*exchange)
        if len(session.heard) == 50:
            raise CallbackStop

    stream = Stream(
        44_100, 64, channels=3, callback=callback, finished_callback=ended.set, laboratory=laboratory(), speed=20.0
    )
    with stream:
        assert ended.wait(EVER)
    offline = Session()
    stepped(offline, 50)
    np.testing.assert_array_equal(counted(session), counted(offline))


@pytest.mark.deadline(0.1)
def test_its_pace_is_that_of_the_rate() -> None:
    session, ended = Session(), threading.Event()

    def callback(*exchange: Any) -> None:
        session(*exchange)
        if session.count >= 44_100:
            raise CallbackStop

    stream = Stream(44_100, 441, channels=3, callback=callback, finished_callback=ended.set, laboratory=laboratory())
    begin = time.monotonic()
    with stream:
        assert ended.wait(EVER)
    assert 0.98 < time.monotonic() - begin < 3.0


@pytest.mark.parametrize("flagged", [True, False])
def test_a_dropped_block_is_lost_and_told_or_not(flagged: bool) -> None:
    session = Session()
    stepped(session, 12, Drop(5, flagged))
    heard = counted(session)
    assert len(session.heard) == 11
    assert session.flags == [flagged and n == 5 for n in range(11)]
    played = 5 * 64
    assert heard[played - 1] + 65 == heard[played]  # what came in meanwhile is gone
    assert np.count_nonzero(heard[200:] == 0) == 64  # and silence was played


@pytest.mark.parametrize("samples", [3, -3, 100])
def test_a_slip_moves_the_recording_for_good(samples: int) -> None:
    session = Session()
    stepped(session, 20, Slip(10, samples))
    heard, late = counted(session), 64 + CONVERTER_DELAY
    np.testing.assert_array_equal(heard[late + 1 : 640], np.arange(2, 641 - late))
    assert heard[-1] == 20 * 64 - late - samples
    assert not any(session.flags)


def test_a_slip_by_more_than_the_latency_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert not stepped(Session(), 2, Slip(0, -62)).active
    assert "a slip by -62 samples: must be >= -61" in capsys.readouterr().err


def test_a_bad_sample_is_one_sample_in_one_channel() -> None:
    session = Session()
    stepped(session, 10, BadSample(4, 2, np.nan))
    wrong = np.argwhere(~np.isfinite(np.concatenate(session.heard)))
    assert wrong.tolist() == [[4 * 64 + 32, 1]]


def test_a_stall_delays_the_callback_and_loses_nothing() -> None:
    session, straight = Session(), Session()
    stepped(session, 10, Stall(4, 0.01))
    stepped(straight, 10)
    np.testing.assert_array_equal(counted(session), counted(straight))


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ({"callback": None}, "callback is None"),
        ({"channels": 4}, "input channels is 4, must be >= 1 and <= 3"),
        ({"channels": (3, 0)}, "output channels is 0, must be >= 1 and <= 3"),
        ({"dtype": "int16"}, "dtype is 'int16', must be 'float32'"),
        ({"device": "USB"}, "device is 'USB', must be 'simulated'"),
    ],
)
def test_what_the_card_has_not_is_refused(wrong: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        Stream(**({"callback": Session(), "laboratory": laboratory()} | wrong))


def test_a_rig_file_chooses_plant_wiring_and_clock() -> None:
    audio = Audio(drive_channels=(2, 5), response_channels=(4, 1))
    for speed, kind in ((0.0, SteppedStream), (2.0, Stream)):
        config = RigConfig(audio=audio, simulator=Simulator(speed=speed, options={"seed": 3}))
        stream = Stream.from_config(config)(callback=Session())
        assert type(stream) is kind
        assert stream.channels == (4, 5)
        assert hasattr(stream, "advance") == (speed == 0)


def test_two_vibrators_are_played_and_recorded_on_four_channels_each() -> None:
    audio = Audio(drive_channels=(1, 2, 3, 4), response_channels=(2, 3, 4, 5), loopback_output=5, loopback_input=1)
    config = RigConfig(
        audio=audio, simulator=Simulator(plant="vibrator-array", options={"noise": -300.0, "hum": -300.0})
    )
    heard: list[np.ndarray] = []

    def callback(indata: np.ndarray, outdata: np.ndarray, *_: Any) -> None:
        heard.append(indata.copy())
        outdata[:] = 0.0
        outdata[0, 2] = 0.1 if len(heard) == 1 else 0.0  # coil 1 of vibrator 2

    stream = Stream.from_config(config)(callback=callback, blocksize=512, channels=(5, 5))
    stream.start()
    stream.advance(8 * 512)
    size = np.abs(np.concatenate(heard)).max(axis=0)
    assert size[0] == 0  # nothing on the cable
    assert size[3] > 1e-4
    assert 1e-3 * size[3] < min(size[1:3]) < max(size[1:3]) < 0.3 * size[3]


def test_without_a_laboratory_it_is_the_default_vibrator() -> None:
    assert Stream(callback=Session()).channels == (3, 3)
