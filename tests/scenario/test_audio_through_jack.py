"""From drive to response through a real audio server: PortAudio, JACK's dummy driver, the plant as a JACK client.

It guards against what a simulated stream cannot show: channel order, block sizes that differ from the server's, a
round trip that changes, a server that dies, and a client that stays behind.
"""

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from benchmarks.jack_server import jack_server, missing, vibrator_client
from ctlblocks.block import Block
from firmware_sim.plant_blocks import ImpulseResponse, Vibrator
from tests.until import EVER
from vibractl.audio import AudioError, Line, ShotAbandoned
from vibractl.capture import Capture
from vibractl.config import Audio, RigConfig

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing())

RATE = 44_100
PERIOD = 2048
QUIET = {"noise": -400.0, "hum": -400.0, "drift": 0.0}


@pytest.fixture
def server() -> Iterator["subprocess.Popen[bytes]"]:
    """Run a server in the mode that moves time, and never data, when a client is late."""
    with jack_server(["-r", "-S"], RATE, PERIOD) as running:
        yield running


def rig(**audio: Any) -> RigConfig:
    wanted = {"stream": "sounddevice:Stream", "device": "shaker", "blocksize": PERIOD}
    return RigConfig(audio=Audio(**(wanted | audio)))


def sweep() -> np.ndarray:
    time = np.arange(RATE) / RATE
    return 3.0 * np.column_stack([np.sin(2 * np.pi * f * time) * np.sin(np.pi * time) ** 2 for f in (40, 76)])


def offline(plant: Block, drive: np.ndarray) -> np.ndarray:
    plant.prepare(float(RATE), len(drive))
    response = np.empty_like(drive)
    plant.process(drive, response)
    return response


def emitted(line: Line) -> Capture:
    """Emit until this machine is not late: in that mode a flag means late, not lost, and discards all the same."""
    while True:
        with suppress(ShotAbandoned):
            return line.emit(sweep())


def first_capture(settings: list[str]) -> Capture:
    """Return the first recording from a vibrator at rest: after a discarded one, friction holds it elsewhere."""
    while True:
        with vibrator_client(settings), Line(rig(attempts=1)) as line, suppress(ShotAbandoned):
            return line.emit(sweep())


@pytest.mark.usefixtures("server")
def test_the_recorded_response_of_the_vibrator_is_that_of_the_plant_offline() -> None:
    expected = offline(Vibrator(seed=3, **QUIET), sweep())
    capture = first_capture(["simulator.options.seed=3", *(f"simulator.options.{k}={v}" for k, v in QUIET.items())])
    assert capture.delay == pytest.approx(2 * PERIOD, abs=1e-6)
    assert np.abs(expected).max() > 5.0
    np.testing.assert_allclose(capture.response, expected, atol=1e-6 * np.abs(expected).max())
    np.testing.assert_array_equal(capture.emitted, sweep().astype(np.float32))


@pytest.mark.slow
@pytest.mark.usefixtures("server")
@pytest.mark.parametrize("blocksize", [PERIOD, pytest.param(1000, marks=pytest.mark.slow)])
def test_shot_after_shot_and_stream_after_stream_the_round_trip_is_the_same(blocksize: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    files = [str(tmp_path / f"{n}.wav") for n in (1, 2)]
    for file in files:
        soundfile.write(file, 0.02 * rng.standard_normal((400, 2)), RATE, subtype="FLOAT")
    expected = offline(ImpulseResponse(files), sweep())
    crossed = {"drive_channels": (4, 2), "response_channels": (1, 4), "loopback_output": 1, "loopback_input": 2}
    names = [f"audio.{key}={list(v) if isinstance(v, tuple) else v}" for key, v in crossed.items()]
    options = ["simulator.plant=impulse-response", f"simulator.options.files={files}"]
    with vibrator_client([*names, *options]):
        for _ in range(2):
            with Line(rig(blocksize=blocksize, **crossed)) as line:
                for _ in range(2):
                    capture = emitted(line)
                    assert capture.delay == pytest.approx(PERIOD + blocksize, abs=1e-6)
                    assert abs(capture.residual) < 1e-6
                    np.testing.assert_allclose(capture.response, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.usefixtures("server")
def test_a_device_or_rate_that_is_not_there_is_one_error_that_says_what_is() -> None:
    there = r"'system' \(2 in, 2 out, 44100 samples/s\), 'shaker' \(3 in, 3 out, 44100 samples/s\)"
    with vibrator_client([]):
        for audio, reason in (
            ({"device": "USB"}, "audio.device 'USB' at 44100"),
            ({"rate": 48_000}, "at 48000 samples/s .*Invalid sample rate"),
            ({"response_channels": (1, 7)}, "has 3 input channels, the rig file needs 7"),
        ):
            with pytest.raises(AudioError, match=f"{reason}.*{there}"), Line(rig(**audio)):
                pass


def emit_for_ever(line: Line) -> None:
    while True:
        emitted(line)


@pytest.mark.slow
def test_a_server_that_dies_in_mid_session_is_one_error_and_nothing_hangs(server: "subprocess.Popen[bytes]") -> None:
    with vibrator_client([]) as client:
        with Line(rig()) as line:
            emitted(line)
            server.terminate()  # a killed one leaves its place in the list of servers, which has eight
            with pytest.raises(AudioError, match="the audio stream has ended by itself|has stalled"):
                emit_for_ever(line)  # a busy machine may let it live for a shot or two
        assert client.wait(EVER) == 2
        assert client.stderr is not None
        assert "the JACK server has ended" in client.stderr.read()


@pytest.mark.slow
@pytest.mark.usefixtures("server")
def test_the_client_ends_at_sigterm_and_ctrl_c() -> None:
    for number in (signal.SIGTERM, signal.SIGINT):
        with vibrator_client([]) as client:
            os.kill(client.pid, number)
            assert client.wait(EVER) == 0
