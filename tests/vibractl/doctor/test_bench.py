"""The line as an instrument: whatever is put on the cable comes back, and nothing is aligned or refused for it."""

from pathlib import Path

import numpy as np
import pytest

from rigkit.stop import Stopped
from tests.vibractl.audio_rig import RATE, ROUND_TRIP
from tests.vibractl.doctor.doctor_rig import SIDES, spoil, wired
from vibractl.capture import Discarded
from vibractl.doctor.bench import Bench


def nothing(_: Discarded) -> None:
    raise AssertionError


def test_any_signal_goes_over_the_cable_and_comes_back_a_round_trip_later(tmp_path: Path) -> None:
    tone = 0.1 * np.sin(2 * np.pi * 66 * np.arange(10_000) / RATE)
    drive = np.zeros((10_000, 2))
    drive[4_000, 1] = 0.1
    with Bench(wired(tmp_path), 1.0, nothing) as bench:
        capture = bench.record(drive, tone)
    np.testing.assert_allclose(capture.loopback[ROUND_TRIP : ROUND_TRIP + 10_000], tone, atol=1e-7)
    np.testing.assert_allclose(capture.response[4_000 + ROUND_TRIP], 0.1 * SIDES[:, 1], rtol=1e-5)
    assert len(capture.response) == 10_000 + RATE // 2


def test_no_cable_at_all_is_no_reason_to_refuse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, lambda _, recorded: recorded[:, 2].fill(0.0))
    with Bench(wired(tmp_path), 1.0, nothing) as bench:
        assert not bench.record(np.zeros((1_000, 2)), np.full(1_000, 0.05)).loopback.any()


def test_the_guard_is_that_of_every_line(tmp_path: Path) -> None:
    with Bench(wired(tmp_path), 1.0, nothing) as bench:
        with pytest.raises(ValueError, match="the drive is not played: drive 1 asks for 9.5 V"):
            bench.record(np.full((1_000, 2), 9.5), np.zeros(0))
        with pytest.raises(ValueError, match=r"must be \(samples, 2\) with 1 to"):
            bench.record(np.zeros((2 * RATE, 2)), np.zeros(0))


def test_it_can_be_stopped_as_every_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    benches: list[Bench] = []
    played = [0]

    def stopping(_: np.ndarray, __: np.ndarray) -> None:
        played[0] += 1
        if played[0] == 30:
            benches[0].stop()

    spoil(monkeypatch, stopping)
    with Bench(wired(tmp_path), 1.0, nothing) as bench:
        benches.append(bench)
        with pytest.raises(Stopped):
            bench.record(np.full((RATE, 2), 1e-3), np.zeros(0))
    assert played[0] < 50
