import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.experiment import RawFolder
from calibration.output import provenance
from calibration.vibrator import LiveLine, calibrate, longest_drive
from calibration.vibrator_multisine import flat_design, multisine_plan
from calibration.vibrator_sweep import first_pass
from ctlblocks import recording
from rigkit import config as rig_file
from rigkit.provenance import now
from rigkit.stop import Stopped, StopRequest
from tests.calibration.killed_calibration import KILLS
from tests.calibration.linear_vibrator import LINEAR, emitter, linear_response
from tests.until import EVER
from vibractl.audio import AudioError
from vibractl.config import RigConfig

SHORT = (
    "characterisation.method=stepped",
    "characterisation.band=[136, 143]",
    "characterisation.settle=0.05",
    "audio.isolated=false",
)


@pytest.mark.slow
def test_a_calibration_killed_at_random_moments_gives_the_undisturbed_model(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.calibration.killed_calibration", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=EVER, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) == KILLS


def test_the_second_pass_is_nearer_the_truth_around_a_sharp_mode(tmp_path: Path) -> None:
    config = rig_file.load(None, RigConfig, SHORT)
    with RawFolder(tmp_path) as raw:
        found = calibrate(config, raw, emitter(1, **LINEAR), provenance(config, now(), {}))
    missed = []
    for matrix in found.passes:
        truth = linear_response(1, matrix.frequency)
        assert 0.2 < np.median(np.abs(matrix.response - truth) ** 2 / matrix.variance) < 4
        size = np.linalg.norm(truth, 2, axis=(1, 2))
        missed.append(np.linalg.norm(matrix.response - truth, 2, axis=(1, 2)) / size)
    assert missed[1].max() < 0.02
    assert missed[1].max() < missed[0].max() / 2
    assert found.matrix is found.passes[1]


def test_one_pass_is_enough_when_that_is_asked_for(tmp_path: Path) -> None:
    config = rig_file.load(None, RigConfig, [*SHORT, "characterisation.passes=1"])
    with RawFolder(tmp_path) as raw:
        found = calibrate(config, raw, emitter(1), provenance(config, now(), {}))
    assert len(found.passes) == 1
    assert found.matrix.frequency.tolist() == np.arange(136.0, 144.0).tolist()
    assert found.seconds == pytest.approx(10 + 8 * 2 * 0.55 + 2 * 0.4 + 0.1, rel=0.02)


@pytest.mark.parametrize("method", ["multisine", "both", "stepped"])
@pytest.mark.parametrize("settings", [(), ("characterisation.period=1.00003", "characterisation.run_in=9.7")])
def test_every_recording_fits_into_the_line(method: str, settings: tuple[str, ...]) -> None:
    config = rig_file.load(None, RigConfig, [f"characterisation.method={method}", *settings])
    lines, tones = multisine_plan(config, "multisine", flat_design(config)[0]), first_pass(config)
    plans = {"multisine": [lines], "stepped": [tones], "both": [lines, tones]}[method]
    longest = max(batch.samples for plan in plans for batch in plan.batches)
    assert longest <= round(longest_drive(config) * config.audio.rate) < 3.5 * longest


def test_over_the_live_line_the_model_says_where_it_comes_from(tmp_path: Path) -> None:
    config = rig_file.load(None, RigConfig, [*SHORT, "characterisation.passes=1", "rig.name=bench"])
    with RawFolder(tmp_path / "model.raw") as raw, LiveLine(config, raw, StopRequest()) as line:
        matrix = calibrate(config, raw, line.emit, provenance(config, now(), {})).matrix
    assert np.isfinite(matrix.response).all()
    assert matrix.provenance["rig"] == "bench"
    assert "model.raw/pass-1-*.wav" in matrix.provenance["recording"]
    assert "136" in matrix.provenance["config"]
    assert "vibrostage" in matrix.provenance["software"]


def test_a_stop_in_the_middle_of_a_batch_ramps_it_down_and_the_calibration_goes_on_later(tmp_path: Path) -> None:
    config = rig_file.load(None, RigConfig, [*SHORT, "characterisation.passes=1", "simulator.speed=20"])
    stop = StopRequest()
    with RawFolder(tmp_path) as raw:
        stop.made = True
        with LiveLine(config, raw, stop) as line, pytest.raises(Stopped):
            calibrate(config, raw, line.emit, provenance(config, now(), {}))
        assert not list(tmp_path.glob("*.wav"))
        assert len(calibrate(config, raw, emitter(1), provenance(config, now(), {})).matrix.frequency) == 8


def test_recordings_that_are_discarded_are_kept_beside_the_others(tmp_path: Path) -> None:
    clipped = ["audio.input_full_scale=0.2", "audio.attempts=2"]
    config = rig_file.load(None, RigConfig, [*SHORT, "characterisation.passes=1", *clipped])
    with RawFolder(tmp_path) as raw, LiveLine(config, raw, StopRequest()) as line:
        with pytest.raises(AudioError, match="clipped"):
            calibrate(config, raw, line.emit, provenance(config, now(), {}))
    kept = sorted((tmp_path / "discarded").iterdir())
    assert len(kept) == 2
    assert recording.read(kept[0]).names[0] == "drive_1"
