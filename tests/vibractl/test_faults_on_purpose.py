"""Sensors and the cable that fail on purpose while a run learns: it is said, or its effect stays small."""

from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from rigkit.faults import KINDS, FaultTable
from rigkit.run_folder import read_events, read_quality
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.audio import Line, ShotAbandoned
from vibractl.run_setup import create, shot_files
from vibractl.session import Session
from vibractl.shot_file import DISCARDED
from vibractl.supervision import Supervision, input_names

FAULTS = KINDS[1:]
SAID = {"nan": "not finite", "inf": "not finite", "full-scale": "clipped"}
"""Of an accelerometer."""
SAID |= {"stuck": "does not move", "zero": "does not move"}
SAID |= {"x10": "response 1 is 10 times as large", "sign-flip": "response 1 is turned round", "delay": "10.0 ms late"}
HARMLESS_ON_THE_CABLE = ("drop", "hum")
"""A chirp's place is found in spite of them."""


def learned(folder: Path, sensor: str, kind: str, law: str = "kalman") -> tuple[Path, str]:
    """Run ten shots, of which four have the fault; return the folder and why the run ended early."""
    config = linear_config("audio.attempts=2", f"learning.law={law}")
    run, made = create(folder / "run", config, linear_model(folder))
    table = FaultTable(input_names(config.audio))
    with run:
        session = Session(run, made, Supervision(faults=table))

        def tell(shot: int, _: object) -> None:
            if shot in (1, 5):
                table.inject(sensor, kind if shot == 1 else "none")

        try:
            session.run(10, tell, lambda: False)
        except (ShotAbandoned, ValueError) as fault:
            return run.path, str(fault)
    return run.path, ""


def loudest(path: Path) -> float:
    """Return the largest drive of a run, V, discarded emissions among them."""
    files = [*shot_files(path), *(path / DISCARDED).glob("*.wav")]
    return max(float(np.abs(recording.read(file).select(["drive_1", "drive_2"]).data).max()) for file in files)


def check(path: Path, reason: str, said: str) -> None:
    """Look at what became of a run."""
    assert loudest(path) < 2.0  # without a fault it is 1.4, and the limit is 9
    worst = [max(float(row[f"worst_line_db_{side}"]) for side in (1, 2)) for row in read_quality(path)]
    if said:
        assert said in reason
        assert len(worst) == 2
        times = 1 if "not the rig that was calibrated" in reason else 2
        assert [event["event"] for event in read_events(path)].count("discarded") == times
    else:
        assert reason == ""
        assert worst[-1] < worst[0] + 6  # four shots after the fault has gone


@pytest.mark.sample(2)
@pytest.mark.parametrize("kind", FAULTS)
def test_an_accelerometer_that_fails_is_named_or_makes_no_drive_louder(tmp_path: Path, kind: str) -> None:
    check(*learned(tmp_path, "response_1", kind), SAID.get(kind, ""))


@pytest.mark.slow
@pytest.mark.parametrize("law", ["kalman", "thesis"])
@pytest.mark.parametrize("sensor", ["response_1", "response_2", "loopback"])
@pytest.mark.parametrize("kind", FAULTS)
def test_every_fault_of_every_input_under_both_laws(tmp_path: Path, kind: str, sensor: str, law: str) -> None:
    path, reason = learned(tmp_path, sensor, kind, law)
    assert loudest(path) <= linear_config().limits.peak
    if sensor != "loopback":
        assert bool(reason) >= (kind in SAID)
    elif kind not in HARMLESS_ON_THE_CABLE:
        assert "recordings were discarded" in reason


@pytest.mark.sample(4)
@pytest.mark.parametrize("kind", FAULTS)
def test_a_cable_that_fails_spoils_the_recording_or_does_no_harm(kind: str) -> None:
    config = linear_config("audio.attempts=1")
    table = FaultTable(input_names(config.audio))
    drive = np.zeros((44_100, 2))
    drive[10_000:30_000] = np.sin(np.arange(20_000) / 50)[:, None] * np.hanning(20_000)[:, None]
    with Line(config, supervision=Supervision(faults=table)) as line:
        before = line.emit(drive)
        table.inject("loopback", kind)
        if kind in HARMLESS_ON_THE_CABLE:
            assert np.allclose(line.emit(drive).response, before.response, atol=1e-3)
        else:
            with pytest.raises(ShotAbandoned):
                line.emit(drive)
