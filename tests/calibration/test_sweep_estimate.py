import numpy as np
import pytest

from calibration.stepped_sine import Tones
from calibration.sweep_estimate import Lines, SweepEstimator, decimation
from calibration.vibrator_sweep import Silence
from ctlblocks.recording import Recording
from rigkit import config as rig_file
from tests.calibration.linear_vibrator import LINEAR, RATE, emitter, linear_response
from vibractl.config import RigConfig

CONFIG = RigConfig()
FREQUENCY = np.array([20.0, 34.0, 60.0, 77.0, 110.0, 200.0, 401.0, 645.0])
PRELOAD = np.array([60.0, 60.0, 72.0, 60.0, 61.0, 63.7, 61.0, 60.6])
NAMES = ("drive_1", "drive_2", "response_1", "response_2")


def batch(preload: float, probe: float = 0.1, settle: float = 1.5) -> Tones:
    wait = np.full(len(FREQUENCY), settle)
    return Tones(FREQUENCY, PRELOAD, wait, 0.5, preload, probe, 2, RATE, decimation(CONFIG))


def recorded(seed: int, drive: np.ndarray, silence: int = 0, **options: float) -> Recording:
    data = np.hstack(emitter(seed, silence, **options)(drive))
    return Recording(NAMES, ("V", "V", "m/s^2", "m/s^2"), RATE, data)


def relative(found: Lines, truth: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(truth, 2, axis=(1, 2))
    return np.asarray(np.linalg.norm(found.response - truth, 2, axis=(1, 2)) / size)


def test_a_linear_vibrator_is_found_within_the_stated_variance() -> None:
    """64 complex errors over two noises: their mean square, in variances, scatters by 1/8 about one."""
    truth, tones, errors = linear_response(1, FREQUENCY), batch(0.5), []
    for silence in (0, 1):
        record = recorded(1, tones.drive(), silence, noise=-45.0, **LINEAR)
        found = SweepEstimator(CONFIG).lines(tones, record)
        errors.append(np.abs(found.response - truth) ** 2 / found.variance)
        assert relative(found, truth).max() < 0.02
    assert 0.6 < np.mean(errors) < 1.6


def test_without_noise_the_error_is_what_has_not_settled() -> None:
    tones = batch(0.5)
    found = SweepEstimator(CONFIG).lines(tones, recorded(1, tones.drive(), noise=-300.0, **LINEAR))
    assert relative(found, linear_response(1, FREQUENCY)).max() < 2e-3


def test_coherence_falls_and_variance_rises_with_noise() -> None:
    tones = batch(0.5)
    quiet, loud = (
        SweepEstimator(CONFIG).lines(tones, recorded(1, tones.drive(), noise=level, **LINEAR))
        for level in (-60.0, -40.0)
    )
    assert np.all(loud.coherence < quiet.coherence)
    assert np.median(loud.variance / quiet.variance) == pytest.approx(100, rel=0.5)
    assert np.all((quiet.coherence > 0.99)[:, [0, 1], [0, 1]])


def test_hum_heard_in_silence_is_in_the_variance_at_its_frequency() -> None:
    tones = Tones(
        np.array([46.0, 50.0, 54.0, 58.0]),
        np.full(4, 72.0),
        np.full(4, 1.0),
        0.5,
        0.5,
        0.1,
        2,
        RATE,
        decimation(CONFIG),
    )
    options = LINEAR | {"hum": -40.0}
    estimator = SweepEstimator(CONFIG)
    estimator.hear_silence(recorded(1, Silence(441_000, 2).drive(), **options))
    found = estimator.lines(tones, recorded(1, tones.drive(), **options))
    missed = np.abs(found.response - linear_response(1, tones.frequency))
    assert np.all(missed[1] < 3 * np.sqrt(found.variance[1]))
    assert missed[1].max() > 0.3 * np.sqrt(found.variance[1]).max()
    assert np.all(found.variance[1] > 10 * found.variance[3])


def test_unloaded_joints_stick_so_that_another_machine_is_measured() -> None:
    """Around a flexural mode the two estimates differ as no noise explains."""
    loaded, unloaded = batch(0.8, settle=0.5), batch(0.0, settle=0.5)
    found = [SweepEstimator(CONFIG).lines(tones, recorded(1, tones.drive(), drift=0.0)) for tones in (loaded, unloaded)]
    assert relative(found[1], found[0].response).max() > 0.2


def test_batches_are_joined_in_order_of_frequency() -> None:
    ones = np.ones((4, 2, 2))

    def lines(start: float) -> Lines:
        frequency = start + np.arange(4.0)
        before = np.stack([np.append(0.0, frequency[:-1]), np.append(frequency[1:], 0.0)], axis=1)
        return Lines(frequency, ones * start, ones, ones, np.full((4, 2), 100.0), before)

    both, _ = SweepEstimator(CONFIG).joined([lines(50.0), lines(20.0)], {"rig": "x"})
    assert both.frequency.tolist() == [20.0, 21.0, 22.0, 23.0, 50.0, 51.0, 52.0, 53.0]
    assert both.response[:, 0, 0].tolist() == [20.0] * 4 + [50.0] * 4
    assert both.variance == pytest.approx(1.0)
    assert both.provenance == {"rig": "x"}


def test_each_line_knows_what_its_input_carried_before_and_for_how_long_it_waited() -> None:
    tones = batch(0.0, settle=0.2)
    found = SweepEstimator(CONFIG).lines(tones, recorded(1, tones.drive(), **LINEAR))
    assert found.before[:, 0].tolist() == [0.0, *FREQUENCY[:-1]]
    assert found.before[:, 1].tolist() == [*FREQUENCY[1:], 0.0]
    assert found.wait[:, 0] == pytest.approx([0.6, *[0.2] * 7])
    assert found.wait[:, 1] == pytest.approx([*[0.2] * 7, 0.6])


def test_decimation_leaves_room_for_the_band() -> None:
    assert decimation(CONFIG) == 16
    wide = rig_file.load(None, RigConfig, ["characterisation.band=[15, 3000]"])
    assert decimation(wide) == 4
