import numpy as np
import pytest

from calibration.multisine_estimate import amplitudes
from calibration.vibrator_multisine import design_of, flat_design
from calibration.working_drive import WorkingDrive, band_drive, reference_drive
from rigkit import config as rig_file
from vibractl.config import RigConfig
from vibractl.transfer_matrix import TransferMatrix


def rig(*settings: str) -> RigConfig:
    return rig_file.load(
        None, RigConfig, ["characterisation.band=[15.0,200.0]", "learning.band=[15.0,200.0]", *settings]
    )


def matrix(turn: complex = 0.5j) -> TransferMatrix:
    """Return a machine of two coils: 4 m/s^2 a volt on the one side, 2 turned by a quarter on the other."""
    frequency = np.arange(15.0, 200.5, 0.2)
    response = np.zeros((len(frequency), 2, 2), complex)
    response[:, 0, 0], response[:, 1, 1] = 4.0, 4.0 * turn
    return TransferMatrix(frequency, response, np.full(response.shape, 1e-6), np.ones(response.shape), {})


def drive_for(*settings: str) -> WorkingDrive:
    return reference_drive(rig(*settings), matrix(), np.random.default_rng(1))


def test_it_has_the_rms_of_the_reference_s_drive_coil_by_coil() -> None:
    made = drive_for("reference.signal=chirp:40:90:5", "reference.amplitude=2", "reference.taper=0")
    rms = np.sqrt(np.mean(made.signal**2, axis=0))
    assert rms == pytest.approx([2 / np.sqrt(2) / 4, 2 / np.sqrt(2) / 2], rel=0.02)


def test_its_lines_are_where_the_reference_is_and_spread_as_that_is() -> None:
    made = drive_for("reference.signal=chirp:40:90:5", "reference.amplitude=2")
    assert 33 < made.bins[0] / 5 < 41  # as far as the tapers reach
    assert 88 < made.bins[-1] / 5 < 97
    assert np.all(made.bins % 2), "even orders of distortion must fall on even lines alone"
    middle = (made.bins > 250) & (made.bins < 400)
    lines = np.abs(amplitudes(made.signal, 0, 500))[made.bins[middle]]
    assert np.ptp(lines, axis=0) == pytest.approx([0, 0], abs=0.2 * lines.max())


def test_coils_are_to_each_other_in_phase_as_the_reference_needs_them() -> None:
    made = drive_for("reference.amplitude=2")
    lines = amplitudes(made.signal, 0, 500)[made.bins]
    assert np.angle(lines[:, 1] / lines[:, 0]) == pytest.approx(-np.pi / 2, abs=0.02)


def test_a_sine_is_one_line_of_its_amplitude() -> None:
    made = drive_for("reference.signal=sine:24:5", "reference.amplitude=2", "learning.overtones=0")
    assert made.bins.tolist() == [121]
    assert np.abs(amplitudes(made.signal, 121, 121)) == pytest.approx(np.array([[0.5, 1.0]]), rel=0.02)


def test_its_peaks_are_close_to_its_rms() -> None:
    made = drive_for("reference.amplitude=2")
    assert np.abs(made.signal[:, 0]).max() < 2.5 * np.sqrt(np.mean(made.signal[:, 0] ** 2))


def test_the_multisine_on_top_is_as_much_below_it_as_on_a_band() -> None:
    config = rig("reference.amplitude=2")
    working = drive_for("reference.amplitude=2")
    over, (flat, _) = design_of(config, 8, -30.0, working)[0], flat_design(config)
    assert over.amplitude[0, 0] / flat.amplitude[0, 0] == pytest.approx(working.rms / 0.36)
    mean = np.mean([over.one_period(number) for number in range(8)], axis=0)
    assert np.allclose(mean, working.signal, atol=1e-12)


def test_a_band_has_the_rms_that_the_settings_ask_for() -> None:
    made = band_drive(rig("characterisation.operating=0.5"), np.random.default_rng(1))
    assert made.rms == pytest.approx(0.5)
    assert made.signal.shape[1] == 1
