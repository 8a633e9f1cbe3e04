import numpy as np
import pytest

from vibractl.learning.reidentify import Probe, Reidentification, probe
from vibractl.learning.shot import Shot

FREQUENCY = np.arange(75, 3_251) / 5
ROOM = np.full(len(FREQUENCY), 0.02)


def plant(centre: float = 545.0) -> np.ndarray:
    """Return G (lines, 2, 2) with a resonance."""
    resonance = 1 / (1 - (FREQUENCY / centre) ** 2 + 0.02j * FREQUENCY / centre)
    return (2.0 + 0.3 * resonance)[:, None, None] * np.array([[1.0, 0.4], [0.3j, 1.0]])


def made(share: float = 0.5) -> Probe:
    response = plant()
    return probe(FREQUENCY, response, 1e-4 * np.abs(response) ** 2, ROOM, 545.0, 10.0, share)


def test_a_probe_stays_within_its_band_and_its_room() -> None:
    chirps = made(share=1.0)
    assert chirps.band == pytest.approx((535.0, 555.0), abs=0.21)
    np.testing.assert_array_equal(chirps.inside, np.abs(FREQUENCY - 545) <= 10.0 + 1e-9)
    for coil in range(2):
        emitted = plant() @ chirps.added(coil)[..., None]
        assert np.abs(emitted).max() <= 0.02
        assert np.abs(emitted).max() > 0.01


def test_a_resonance_that_moves_by_a_quarter_of_the_half_width_does_not_lift_the_probe_above_its_room() -> None:
    chirps = made(share=1.0)
    for centre in (542.5, 547.5):
        assert np.abs(plant(centre) @ chirps.added(0)[..., None]).max() <= 1.02 * 0.02


def test_the_chirp_of_a_probe_rises_evenly_over_the_shot() -> None:
    spectrum = np.zeros(5_001, complex)
    spectrum[75:3_251] = made().lines[0]
    signal = np.fft.irfft(spectrum)
    half = len(signal) // 2
    early, late = (2 * np.abs(np.fft.rfft(part)).argmax() * 0.2 for part in (signal[:half], signal[half:]))
    assert 536 < early < 545 < late < 554
    assert np.abs(signal).max() < 4 * np.sqrt(np.mean(signal**2))  # spread out, not a click


def test_the_evidence_is_what_each_coil_did_beside_the_shot_before() -> None:
    response, chirps = plant(548.0), made()
    drive = np.full((len(FREQUENCY), 2), 0.1 + 0j)
    quiet = np.full((len(FREQUENCY), 2), 1e-12)

    def shot(lines: np.ndarray) -> Shot:
        return Shot(lines, (response @ lines[..., None])[..., 0], quiet)

    running = Reidentification(chirps, 545.0, shot(drive), zeroed=False)
    assert not running.take(shot(running.drive))
    assert running.take(shot(running.drive))
    for coil, (step, change, noise) in enumerate(running.evidence()):
        inside = chirps.inside
        np.testing.assert_allclose(change[inside] / step[inside, coil, None], response[inside, :, coil], rtol=1e-9)
        np.testing.assert_array_equal(noise, 2 * quiet)
    assert running.repeatability == pytest.approx(0.0, abs=1e-24)


def test_zeroing_the_drive_meanwhile_gives_a_wrong_estimate() -> None:
    """The text's own variant: the response before still holds what the drive did that was taken away."""
    response, chirps = plant(), made()
    drive = np.where(chirps.inside[:, None], 0.02 + 0j, 0.0) * np.ones((1, 2))
    base = Shot(drive, (response @ drive[..., None])[..., 0], np.zeros((len(FREQUENCY), 2)))
    running = Reidentification(chirps, 545.0, base, zeroed=True)
    for _ in range(2):
        running.take(Shot(running.drive, (response @ running.drive[..., None])[..., 0], base.noise))
    step, change, _ = next(running.evidence())
    line = int(np.argmin(np.abs(FREQUENCY - 545)))
    estimate = change[line, 0] / step[line, 0]
    assert abs(estimate - response[line, 0, 0]) > 0.7 * abs(response[line, 0, 0])
