from pathlib import Path

import numpy as np
import pytest

from benchmarks.identification import BANDS, FREQUENCY, errors, truth_at_preload
from calibration.experiment import RawFolder, refuse_to_emit
from calibration.vibrator import Calibration, calibrate
from calibration.vibrator_multisine import PROBES
from ctlblocks import recording
from rigkit import config as rig_file
from tests.calibration.linear_vibrator import ABOUT, LINEAR, emitter, linear_response
from vibractl.audio import Clipped
from vibractl.config import RigConfig
from vibractl.decibels import decibels
from vibractl.judging import Judging
from vibractl.quality import Judge

SHORT = ("band=[100, 160]", "records=4", "period=2", "run_in=0.3")


def config(*settings: str) -> RigConfig:
    texts = ("method=multisine", *settings)
    return rig_file.load(None, RigConfig, [f"characterisation.{text}" for text in texts])


def found(folder: Path, *settings: str) -> Calibration:
    with RawFolder(folder) as raw:
        return calibrate(config(*settings), raw, emitter(1), ABOUT)


@pytest.mark.slow
def test_45_seconds_find_a_nonlinear_vibrator_within_the_stated_variance(tmp_path: Path) -> None:
    """Against the linearisation around the same preload, whose own error is a third of the model's or so.

    The whole table is benchmarks/identification.py.
    """
    measured = found(tmp_path)
    assert measured.seconds < 45
    relative, normalised = errors(measured.matrix, truth_at_preload(1, rounds=1, records=48))
    for (low, high), most in zip(BANDS, (0.14, 0.18, 0.15, 0.07), strict=True):
        assert np.percentile(relative[(FREQUENCY >= low) & (FREQUENCY < high)], 95) < most
    assert 0.2 < np.median(normalised) < 1.0
    assert 1.0 < np.percentile(normalised, 95) < 6.0


def around_reference(folder: Path, *settings: str, **plant: float) -> Calibration:
    texts = ["characterisation.around=reference", "characterisation.records=4", "characterisation.period=2", *settings]
    with RawFolder(folder) as raw:
        return calibrate(rig_file.load(None, RigConfig, texts), raw, emitter(2, **plant), ABOUT)


def test_a_model_of_a_linear_vibrator_around_its_reference_is_right(tmp_path: Path) -> None:
    measured = around_reference(tmp_path, **LINEAR)
    truth = linear_response(2, measured.matrix.frequency)
    off = np.linalg.norm(measured.matrix.response - truth, axis=(1, 2)) / np.linalg.norm(truth, axis=(1, 2))
    assert np.median(off) < 0.01
    assert measured.seconds == pytest.approx(2 * 4 * 2.6), "first around a band, then around the reference"
    assert measured.levels is not None
    working = measured.levels.preload[(measured.levels.frequency > 45) & (measured.levels.frequency < 85)]
    wanted = 10.0 / np.sqrt(2) / np.sqrt(50)  # rms of a Hz of a chirp of 10 m/s^2 over 50 Hz
    assert np.sqrt(2 * np.mean(working**2) / 2) == pytest.approx(wanted, rel=0.1)  # two lines a Hz, by their amplitudes


def test_a_reference_that_the_guard_would_stop_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(
        ValueError, match=r"around = reference, at reference.amplitude 200 m/s\^2, gives a multisine with"
    ):
        around_reference(tmp_path, "reference.amplitude=200", **LINEAR)


def quiet(folder: Path, amplitude: float, **plant: float) -> tuple[RigConfig, Calibration]:
    """Calibrate a plant quietly, for a reference of an amplitude, m/s^2."""
    settings = [f"reference.amplitude={amplitude}", "reference.signal=chirp:40:90:5"]
    rig = rig_file.load(None, RigConfig, ["characterisation.quiet=true", *settings])
    with RawFolder(folder) as raw:
        return rig, calibrate(rig, raw, emitter(2, **plant), ABOUT)


@pytest.mark.slow
def test_a_quiet_model_of_a_linear_vibrator_is_right(tmp_path: Path) -> None:
    _, measured = quiet(tmp_path, 10.0, **LINEAR)
    truth = linear_response(2, measured.matrix.frequency)
    off = np.linalg.norm(measured.matrix.response - truth, axis=(1, 2)) / np.linalg.norm(truth, axis=(1, 2))
    assert np.median(off) < 0.01
    assert np.quantile(off, 0.95) < 0.03


@pytest.mark.sample(1)
@pytest.mark.parametrize("amplitude", [1.0, 10.0])
def test_a_quiet_one_emits_nothing_over_the_limit(tmp_path: Path, amplitude: float) -> None:
    """The reference's judge hears every recording, ramps and all, as it hears a shot."""
    rig, measured = quiet(tmp_path, amplitude, hum=-200.0)
    assert measured.over is not None
    assert -8 < measured.over < 0
    assert measured.seconds < 60
    kinds = sorted({path.name[:-8] for path in tmp_path.glob("*.wav")})
    assert kinds == ["multisine", *(f"probe-{number}" for number in range(1, len(kinds) - 1)), "scout"]
    assert 4 <= len(kinds) <= 2 + PROBES
    judge, worst = Judge(Judging.of(rig)), []
    for path in tmp_path.glob("multisine-*.wav"):
        heard = recording.read(path).data[:, 2:]
        for first in (0, len(heard) - 220_500):
            lines = np.fft.rfft(heard[first : first + 220_500], axis=0)[500:3_200] / 44_100  # 100 to 640 Hz
            worst.append(decibels(lines / judge.limit).max())
    assert len(worst) == 12
    assert -10 < max(worst) < 0


def test_below_the_band_that_is_judged_no_line_is_too_loud(tmp_path: Path) -> None:
    assert found(tmp_path, "band=[60, 90]", "records=3", "period=2", "run_in=0.3").loudest is None


def test_stopped_after_any_record_it_goes_on_to_the_same_model(tmp_path: Path) -> None:
    rig, played = config(*SHORT), 0

    def failing(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nonlocal played
        played += 1
        if played == 4:
            raise InterruptedError
        return emitter(1)(drive)

    with pytest.raises(InterruptedError), RawFolder(tmp_path / "stopped") as raw:
        calibrate(rig, raw, failing, ABOUT)
    assert len(list((tmp_path / "stopped").glob("*.wav"))) == 3
    models = []
    for name in ("stopped", "undisturbed"):
        with RawFolder(tmp_path / name) as raw:
            models.append(calibrate(rig, raw, lambda drive: emitter(1)(drive), ABOUT).matrix)
    assert (models[0].response == models[1].response).all()
    assert (models[0].variance == models[1].variance).all()


def test_both_measures_uncertain_lines_again_by_a_stepped_sine(tmp_path: Path) -> None:
    measured = found(tmp_path, *SHORT, "method=both")
    assert 4 <= len(measured.tones) <= 40
    assert np.isin(measured.tones, measured.matrix.frequency).all()
    assert (tmp_path / "tones-000.wav").is_file()
    assert measured.seconds > len(measured.tones) * 2 * 0.8


def test_the_model_covers_the_band_and_says_where_it_comes_from(tmp_path: Path) -> None:
    matrix = found(tmp_path / "m.raw", *SHORT).matrix
    assert matrix.frequency[0] == 100
    assert matrix.frequency[-1] == 160
    assert "m.raw/multisine-*.wav" in matrix.provenance["recording"]
    assert matrix.provenance["rig"] == "simulated-vibrator"


def test_where_a_sensor_clips_it_is_played_again_at_half_and_found_as_well(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole, room = emitter(2, **LINEAR), 40.0

    def clipping(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        emitted, response = whole(drive)
        if np.abs(response).max() > room:
            raise Clipped("3 recordings were discarded: clipped at full scale, response 1 at 0.5 s, and 7 more")
        return emitted, response

    loud = config(*SHORT, "operating=3.0", "probe=0.3")
    with RawFolder(tmp_path) as raw:
        measured = calibrate(loud, raw, clipping, ABOUT)
        told = capsys.readouterr().err
        assert "multisine: 3 recordings were discarded: clipped" in told
        assert "again, 6 dB weaker" in told
        again = calibrate(loud, raw, refuse_to_emit, ABOUT)
    played = max(float(np.abs(recording.read(file).data[:, 2:]).max()) for file in tmp_path.glob("multisine-*.wav"))
    assert room / 4 < played <= room, "no weaker than it has to be"
    np.testing.assert_array_equal(again.matrix.response, measured.matrix.response)
    with RawFolder(tmp_path / "quiet") as raw:
        asked = calibrate(config(*SHORT, "operating=0.375", "probe=0.0375"), raw, emitter(2, **LINEAR), ABOUT)
    off = np.abs(measured.matrix.response - asked.matrix.response) / np.sqrt(2 * asked.matrix.variance)
    assert np.median(off) < 1.0, "as sure as one that is asked for at that level"


def test_what_clips_however_weak_it_is_says_so(tmp_path: Path) -> None:
    def clipping(drive: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if drive.any():
            raise Clipped("3 recordings were discarded: clipped at full scale")
        return drive, drive

    with RawFolder(tmp_path) as raw, pytest.raises(Clipped, match="clipped at full scale"):
        calibrate(config(*SHORT), raw, clipping, ABOUT)
