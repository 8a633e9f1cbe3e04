"""The transfer matrix comes out of any recording that excites enough, with variances that hold, and nothing else."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from calibration.from_recordings import Found, FromRecordingsError, matrix_from
from calibration.from_verdict import verdicts
from calibration.multisine_estimate import FLOOR
from calibration.recorded_signals import Recorded
from ctlblocks.recording import RecordingError
from tests.calibration.recorded_lab import (
    BAND,
    alone,
    heard,
    multisine,
    noise,
    recorded,
    records,
    signals,
    sweep,
    truth,
)
from tests.vibractl.linear_rig import RATE, linear_config
from vibractl.model_file import read_model, write_model

WORDS = {"rig": "simulated-vibrator"}


def found_from(each: Sequence[Recorded], correct_clock: bool = False) -> Found:
    return matrix_from(each, linear_config(*BAND), WORDS, correct_clock)


def error(found: Found) -> np.ndarray:
    """Return the errors of G, (lines, outputs, inputs)."""
    return np.abs(found.matrix.response - truth(found.matrix.frequency))


def relative(found: Found, truly: np.ndarray | None = None) -> float:
    """Return the median error relative to |G|."""
    there = truth(found.matrix.frequency) if truly is None else truly
    off = np.linalg.norm(found.matrix.response - there, axis=(1, 2)) / np.linalg.norm(there, axis=(1, 2))
    return float(np.median(off))


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "drives",
    [
        [noise(3)],
        [alone(sweep(), 0), alone(sweep(), 1)],
        [np.stack([sweep(), sweep()], axis=1), np.stack([sweep(), -sweep()], axis=1)],
        [np.concatenate([multisine(3), multisine(4)])],
    ],
    ids=["noise", "sweeps in turn", "sweeps together", "multisines"],
)
def test_it_is_right_within_what_it_says(drives: list[np.ndarray]) -> None:
    found = found_from(records(drives, 4.0))
    assert len(found.matrix.frequency) == len(found.wanted)
    floor = FLOOR**2 * (np.abs(found.matrix.response) ** 2).mean(axis=(1, 2), keepdims=True)
    share = error(found) ** 2 / (found.matrix.variance - floor)
    assert 0.4 < np.median(share) < 1.2  # of a complex Gaussian: ln 2
    assert 0.5 < np.mean(share) < 2.0
    assert relative(found) < 0.3


@pytest.mark.slow
def test_four_records_are_twice_as_certain_as_one() -> None:
    one, four = found_from(records([noise(1)], 10.0)), found_from(records([noise(n) for n in range(1, 5)], 10.0))
    assert np.median(error(four)) < 0.65 * np.median(error(one))


def test_a_noisy_record_hardly_counts_beside_a_clean_one() -> None:
    clean, noisy = records([noise(1), noise(2)], 0.3), recorded(noise(3), heard(noise(3), 30.0))
    with_it = np.median(error(found_from([*clean, noisy])))
    assert with_it < 1.1 * np.median(error(found_from(clean)))


def test_records_that_disagree_are_less_certain_than_each_says() -> None:
    """As where the response depends on the level: noise alone is small in each."""
    drives = [noise(n) for n in range(1, 5)]
    grown = [recorded(drive, (1 + 0.1 * n) * heard(drive, 0.3, n)) for n, drive in enumerate(drives)]
    found = found_from(grown)
    off = error(found) ** 2 / found.matrix.variance
    scatter = np.abs(found.matrix.response - 1.15 * truth(found.matrix.frequency)) ** 2 / found.matrix.variance
    assert np.median(off) < 10
    assert np.median(scatter) < 2


def test_without_noise_what_is_left_is_the_floor_of_amplitude() -> None:
    found = found_from(records([noise(1), noise(2)], 0.0))
    size = np.sqrt((np.abs(found.matrix.response) ** 2).mean(axis=(1, 2)))
    deviation = np.sqrt(found.matrix.variance).max(axis=(1, 2))
    assert np.median(deviation / size) == pytest.approx(FLOOR, rel=0.1)


@pytest.mark.slow
def test_a_multisine_tells_its_averages_noise_and_distortion() -> None:
    drive = multisine(7, periods=5, step=2)
    lines = np.count_nonzero(np.abs(np.fft.rfft(drive[: 2 * RATE, 0])) > 1.0)
    of_noise = 0.03**2 * lines / RATE / np.mean(heard(drive, 0.0) ** 2, axis=0)
    found = []
    for bent in (0.0, 1.0):
        each = found_from([recorded(drive, heard(drive, 0.03, nonlinearity=bent)), *records([noise(3)])])
        found.append(each.records[0].multisine)
    linear, bent_one = found
    assert linear is not None
    assert bent_one is not None
    assert (linear.period, linear.multisines) == (2.0, 1)
    assert linear.averages in (4, 5)
    assert np.allclose(linear.noise, 10 * np.log10(of_noise), atol=1.0)
    assert np.isnan(linear.odd).all()  # every odd line is excited
    assert np.all(bent_one.even > np.maximum(linear.even, bent_one.noise) + 20)


@pytest.mark.parametrize(
    ("drives", "reason"),
    [
        ([np.stack([sweep(), 1.2 * sweep()], axis=1)], "the drives are correlated and not distinguishable"),
        ([alone(sweep(), 0)], "drive 2 is not excited"),
    ],
)
def test_what_cannot_be_told_apart_gives_no_model(drives: list[np.ndarray], reason: str) -> None:
    with pytest.raises(FromRecordingsError, match=f"no model comes of this: 30 to 130 Hz: {reason}"):
        found_from(records(drives))


def test_responses_that_have_nothing_to_do_with_the_drives_give_no_model() -> None:
    with pytest.raises(FromRecordingsError, match="no model comes of this: 30 to 130 Hz: the responses do not follow"):
        found_from([recorded(noise(1), heard(noise(2)))])


def test_outside_of_what_is_excited_there_is_no_value_and_nothing_is_made_up_there(tmp_path: Path) -> None:
    found = found_from(records([alone(sweep(50, 90), 0), alone(sweep(50, 90), 1)], 30.0))
    frequency = found.matrix.frequency
    assert frequency[0] > 40
    assert frequency[-1] < 140
    assert any("excited" in gap.reason and gap.high == 130.0 for gap in found.gaps)
    assert [each.word for each in verdicts(found)] == ["usable", "no value"]
    write_model(tmp_path / "m.h5", found.matrix)
    model, some = read_model(tmp_path / "m.h5"), np.linspace(55.0, 80.0, 7)
    assert np.allclose(model.at(some).response, found.matrix.at(some).response)
    with pytest.raises(ValueError, match="bins 35 to 60 Hz are wanted, the model was measured from"):
        model.at(np.array([35.0, 60.0]))


def test_a_gap_in_the_middle_is_not_bridged() -> None:
    low, high = sweep(25, 60), sweep(90, 150)
    matrix = found_from(records([alone(each, side) for each in (low, high) for side in (0, 1)], 30.0)).matrix
    with pytest.raises(
        ValueError, match=r"bins 40 to 120 Hz are wanted, the model has no value from .* are (hardly|not)"
    ):
        matrix.at(np.array([40.0, 75.0, 100.0, 120.0]))
    assert len(matrix.at(np.array([40.0, 45.0, 110.0, 120.0])).frequency) == 4


def test_responses_that_come_late_are_late_in_the_model() -> None:
    drives = [noise(1), noise(2)]
    found = found_from([recorded(drive, np.vstack((np.zeros((600, 2)), heard(drive)))) for drive in drives])
    frequency = found.matrix.frequency
    assert relative(found, truth(frequency) * np.exp(-2j * np.pi * frequency * 600 / RATE)[:, None, None]) < 0.03
    assert found.is_late


@pytest.mark.parametrize(
    ("samples", "reason"),
    [
        ((0, 9_000), r"b.wav: responses come 0\.2\d\d s after drives, and 0\.0\d\d s in the first recording, must be"),
        ((0, 30), r"b.wav: responses come 0\.0006\d\d s later beside their drives than in a.wav, must be within a"),
        ((9_000, 0), r"a.wav: responses come 0\.2\d\d s after drives, must be within 0\.05 s"),
    ],
)
def test_files_that_begin_apart_are_refused_or_put_beside_each_other(samples: tuple[int, int], reason: str) -> None:
    both = [
        recorded(noise(n), np.vstack((np.zeros((later, 2)), heard(noise(n), 0.1, n))), name)
        for n, name, later in zip((1, 2), ("a.wav", "b.wav"), samples, strict=True)
    ]
    with pytest.raises(FromRecordingsError, match=reason):
        found_from(both)
    found = found_from(both, correct_clock=True)
    deviation = np.sqrt(found.matrix.variance.sum(axis=(1, 2))) / np.linalg.norm(found.matrix.response, axis=(1, 2))
    assert np.median(deviation) < 0.02  # were they apart by 30 samples still, it would be 0.06


def test_a_silent_beginning_is_no_transient() -> None:
    """The first lines of a sweep are told from a transient by the silence before it."""
    drives = [alone(sweep(28.0, 150.0, 3.0), side) for side in (0, 1)]
    found = found_from(records(drives, 1.0))
    assert found.matrix.frequency[0] == 30.0


@pytest.mark.parametrize(
    ("drive", "response", "reason"),
    [
        (noise(1)[:50_000], heard(noise(1))[:50_000], "a.wav: 1.13 s, must be at least 2 s"),
        (noise(1), heard(noise(1))[:90_000], "a.wav: 90000 samples, drive-a.wav has 220500, must be nearly as many"),
        (noise(1), heard(noise(1)) * [1, 0], "a.wav: response 2 never changes, must move"),
        (0 * noise(1), heard(noise(1)), "drive-a.wav: silent from 20 to 140 Hz, must drive there"),
        (noise(1), np.clip(heard(noise(1)), -20, 20), "a.wav: response . is clipped at full scale, 20 m/s"),
    ],
)
def test_a_record_that_is_none_is_refused(drive: np.ndarray, response: np.ndarray, reason: str) -> None:
    with pytest.raises((FromRecordingsError, RecordingError), match=reason):
        found_from([recorded(drive, response, full_scale=20.0 if "clipped" in reason else np.inf)])


def test_a_table_that_does_not_say_its_length_gives_the_same() -> None:
    drive, response = noise(1, 6.0), heard(noise(1, 6.0))
    whole = found_from([recorded(drive, response)])
    unknown = [signals(each, "a.csv") for each in (drive, response)]
    for each in unknown:
        object.__setattr__(each, "frames", None)
    other = found_from([Recorded(*unknown)])
    assert np.allclose(other.matrix.response, whole.matrix.response, rtol=0.05)
