"""A vibrator whose G is another one at each moment of a shot."""

import numpy as np
import pytest

from rigkit.fade import rise
from tests.vibractl.learning.line_plant import LinePlant, law_of, matrix_of, modal
from vibractl.config import Adaptation, Watch
from vibractl.learning.algorithm import Algorithm
from vibractl.learning.line_filter import LineFilter
from vibractl.learning.shot import Shot
from vibractl.learning.variation import Variation, solved

FREQUENCY = np.arange(15.0, 215.0)
EDGE = 0.04
"""s, of a shot of one."""


def spectra(seed: int, *shape: int) -> np.ndarray:
    """Return complex noise."""
    rng = np.random.default_rng(seed)
    drawn: np.ndarray = rng.standard_normal(shape) + 1j * rng.standard_normal(shape)
    return drawn


def made_by(variation: Variation, rows: np.ndarray, drive: np.ndarray) -> np.ndarray:
    """Return the response of G and its variations, `rows` (lines, outputs, parts x inputs)."""
    response: np.ndarray = (rows @ variation.parts(drive)[..., None])[..., 0]
    return response


def test_weights_are_of_mean_zero_so_that_g_is_what_it_is_on_average() -> None:
    """A line is heard at others of the weighed drives, and not at its own."""
    drive = np.zeros((200, 1), complex)
    drive[100] = 1.0
    weighed = Variation(FREQUENCY, 0.0, 0.0, 3).parts(drive)[:, 1:]
    assert np.abs(weighed[100]).max() < 1e-12
    assert np.abs(weighed[[97, 98, 99, 101, 102, 103]]).max(axis=0).min() > 0.02


def test_a_swing_of_n_periods_moves_a_line_by_n() -> None:
    drive = np.zeros((200, 1), complex)
    drive[100] = 1.0
    cosine = Variation(FREQUENCY, 0.0, 0.0, 3).parts(drive)[:, 1 + 2 + 4]
    expected = np.zeros(200)
    expected[[97, 103]] = 0.5
    np.testing.assert_allclose(np.abs(cosine), expected, atol=1e-9)


def test_gathering_is_the_adjoint_of_parting() -> None:
    variation = Variation(FREQUENCY, EDGE, 0.0, 4)
    drive, parts = spectra(1, 200, 2), spectra(2, 200, 22)
    assert np.vdot(parts, variation.parts(drive)) == pytest.approx(np.vdot(variation.gathered(parts), drive))


def test_what_is_emitted_of_lines_are_those_of_the_drive_with_its_edges() -> None:
    """As the FFT of all samples has them."""
    frames, rate = 4_000, 4_000.0
    bins, drive = np.zeros((frames // 2 + 1, 2), complex), spectra(5, 200, 2)
    bins[15:215] = drive
    signal = np.fft.irfft(bins, frames, axis=0)
    edge = round(EDGE * rate)
    signal[:edge] *= rise(edge)[:, None]
    signal[-edge:] *= rise(edge)[::-1, None]
    emitted = Variation(FREQUENCY, EDGE, 0.0, None).parts(drive)
    np.testing.assert_allclose(emitted, np.fft.rfft(signal, axis=0)[15:215], atol=0.03 * np.abs(emitted).max())
    assert np.linalg.norm(emitted - drive) > 0.1 * np.linalg.norm(drive)


def test_a_line_too_weak_to_be_driven_costs_no_other_line_anything() -> None:
    """G^+ hardly drives it: it stays as it is, and conjugate gradients do not chase it."""
    response = np.ones((200, 1, 1), complex)
    response[40:60] = 1e-3
    inverse = response.conj() / (np.abs(response) ** 2 + 1e-3)
    variation = Variation(FREQUENCY, EDGE, 0.0, None)
    wanted = Variation(FREQUENCY, 0.2, 0.0, None).parts(spectra(6, 200, 1))  # which edges leave room for

    def respond(drive: np.ndarray) -> np.ndarray:
        return made_by(variation, response, drive)

    found = solved(response, variation, inverse, wanted, np.ones((200, 1)))
    plain = (inverse @ wanted[..., None])[..., 0]
    assert np.linalg.norm(found[40:60]) < 2 * np.linalg.norm(plain[40:60])
    promised, far = response[:, :, 0] * plain, slice(65, 200)
    assert np.linalg.norm((promised - respond(found))[far]) < 0.3 * np.linalg.norm((promised - respond(plain))[far])


def varying(size: float) -> tuple[Variation, np.ndarray]:
    """Return a G of about 1 with a deep notch at line 100, and variations of `size`."""
    variation = Variation(FREQUENCY, 0.0, 0.0, 2)
    steady = 0.02 + np.abs(np.arange(200) - 100.0) / 20
    rows = np.concatenate([steady[:, None, None], size * np.ones((200, 1, 6))], axis=2).astype(complex)
    return variation, rows


def test_a_notch_that_hears_its_neighbours_more_than_itself_is_solved() -> None:
    """Line by line the error there grows."""
    variation, rows = varying(0.1)
    inverse = 1 / rows[..., :1]
    wanted = spectra(3, 200, 1)
    plain = (inverse @ wanted[..., None])[..., 0]
    notch = slice(95, 106)
    assert np.linalg.norm((wanted - made_by(variation, rows, plain))[notch]) > np.linalg.norm(wanted[notch])
    found = solved(rows, variation, inverse, wanted, np.ones((200, 1)))
    assert np.linalg.norm((wanted - made_by(variation, rows, found))[notch]) < 0.3 * np.linalg.norm(wanted[notch])


def test_nothing_wanted_moves_nothing() -> None:
    variation, rows = varying(0.06)
    found = LineFilter(rows[..., :1], np.full((200, 1, 1), 0.01), 0.01, 0.1, 2, variation)
    step = found.step_for(np.zeros((200, 1), complex), 1 / rows[..., :1], np.ones((200, 1)))
    np.testing.assert_array_equal(step, 0.0)


def test_a_line_that_is_kept_is_not_moved_for_its_neighbours() -> None:
    variation, rows = varying(0.06)
    found = LineFilter(rows[..., :1], np.full((200, 1, 1), 0.01), 0.01, 0.1, 2, variation)
    inverse = 1 / rows[..., :1]
    inverse[50:60] = 0.0
    step = found.step_for(spectra(3, 200, 1), inverse, np.ones((200, 1)))
    assert np.abs(step[50:60]).max() == 0.0
    assert np.abs(step[60:]).min() > 0.0


def test_the_filter_finds_variations_and_tells_them_from_g() -> None:
    variation, rows = varying(0.1)
    found = {}
    for known in (variation, None):
        filtered = LineFilter(rows[..., :1], np.full((200, 1, 1), 1e-4), 1e-3, 0.0, 4, known)
        for shot in range(25):
            step = spectra(10 + shot, 200, 1)
            filtered.observe(step, made_by(variation, rows, step), np.full((200, 1), 1e-6))
        step = spectra(9, 200, 1)
        found[known is variation] = np.linalg.norm(made_by(variation, rows, step) - filtered.explained(step))
    assert found[True] < 0.2 * found[False]


class VaryingPlant(LinePlant):
    """At its ends, and with one swing, its G is another one by half and by a fifth."""

    other: np.ndarray

    def shot(self, drive: np.ndarray) -> Shot:
        variation = Variation(np.arange(len(drive)) + 15.0, 0.0, 0.0, 1)
        weighed = variation.parts(drive).reshape(len(drive), 5, -1)[:, 1:]
        beside = np.einsum("loi,lji,j->lo", self.other, weighed, [0.5, 0.5, 0.2, 0.2])
        plain = super().shot(drive)
        return Shot(drive, plain.response + beside, plain.noise)


def test_a_learning_that_follows_variations_leaves_less_error() -> None:
    true = modal(2, 2)
    left = []
    for varies in (False, True):
        law = law_of(matrix_of(true))
        algorithm = Algorithm(law, Adaptation(variation=varies), Watch(), -40.0)
        plant = VaryingPlant(true, law, distortion=0.1)
        plant.other = np.roll(plant.response, 1, axis=1)
        for _ in range(12):
            shot = plant.shot(algorithm.lines)
            algorithm.step(shot)
        left.append(float(np.linalg.norm(law.reference - shot.response)))
    assert left[1] < 0.6 * left[0]
