"""Tests of how a shot is judged: signals whose marks are known."""

import numpy as np
import pytest
from scipy.signal import hilbert

from vibractl.config import RigConfig
from vibractl.decibels import decibels
from vibractl.mains import Hum
from vibractl.quality import Judge, Marks, holds_from
from vibractl.setup import Setup, setup
from vibractl.transfer_matrix import TransferMatrix

RATE, SECONDS, JUDGED = 44_100, 2.0, 2.4
"""Samples/s; s that the chirp lasts, and with the silence after it."""
SILENT = np.zeros((1, 2))


def made_for(reference: str, **learning: object) -> Setup:
    """Set up a run on a rig whose sides do not touch each other: 10 m/s^2 per V at every line."""
    frequency = np.arange(15.0, 651.0)
    response = np.broadcast_to(10.0 * np.eye(2) + 0j, (len(frequency), 2, 2))
    known = np.full(response.shape, 1e-6), np.ones(response.shape)
    config = RigConfig.model_validate({"reference": {"signal": reference}, "learning": learning})
    return setup(config, TransferMatrix(frequency, response, *known, {"rig": "simulated-vibrator"}))


@pytest.fixture(scope="module")
def made() -> Setup:
    """Return a run of a chirp on both sides."""
    return made_for(f"chirp:40:90:{SECONDS:g}")


@pytest.fixture(scope="module")
def judge(made: Setup) -> Judge:
    """Return its judge."""
    return Judge(made)


def marks(judge: Judge, made: Setup, added: np.ndarray | float, scale: float = 1.0) -> Marks:
    """Judge `scale` times the reference plus what is added to side 1."""
    response = np.zeros((made.shot.total, 2))
    response[made.shot.window] = scale * made.reference.signal
    response[made.shot.lead :, 0] += added
    return judge.marks(response, SILENT)


def tone(frequency: float, amplitude: float, seconds: float = JUDGED) -> np.ndarray:
    """Return a tone as long as what is judged."""
    return amplitude * np.sin(2 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE)


def test_the_reference_itself_meets_the_objective_with_no_error(judge: Judge, made: Setup) -> None:
    perfect = marks(judge, made, 0.0)
    assert perfect.met
    assert perfect.error_db.max() < -90  # of the decimator's edge
    assert perfect.worst_line_db.max() < -60
    assert perfect.reason.startswith("met by")


def test_half_the_reference_is_an_error_of_minus_6_db_and_half_the_iae_of_silence(judge: Judge, made: Setup) -> None:
    half, silence = marks(judge, made, 0.0, 0.5), marks(judge, made, 0.0, 0.0)
    np.testing.assert_allclose(half.error_db, -20 * np.log10(2), atol=1e-3)
    np.testing.assert_allclose(2 * half.iae, silence.iae, rtol=1e-4)
    expected = np.abs(made.reference.signal[::4]).sum(axis=0)
    np.testing.assert_allclose(silence.iae, expected, rtol=1e-4)


def test_the_limit_is_40_db_under_the_chirps_own_spectrum(judge: Judge) -> None:
    """The spectrum of a linear chirp is A / 2 / sqrt(sweep rate) in its band, but for Fresnel ripples."""
    plateau = 10.0 / 2 / np.sqrt(50.0 / SECONDS)
    np.testing.assert_allclose(decibels(judge.limit / plateau), -40.0, atol=0.5)


def test_a_tone_of_twice_the_limit_is_6_db_over_at_its_own_line(judge: Judge, made: Setup) -> None:
    amplitude = 2 * judge.limit[0] / (JUDGED / 2)
    missed = marks(judge, made, tone(310.0, amplitude))
    assert missed.worst_line_db[0] == pytest.approx(20 * np.log10(2), abs=0.05)
    assert missed.worst_line_hz[0] == pytest.approx(310.0)
    assert not missed.met
    assert "missed by 6.0 dB at 310.0 Hz, response 1" in missed.reason
    lines_a_band = 50.0 * JUDGED
    assert missed.worst_band_db[0] == pytest.approx(20 * np.log10(2 / np.sqrt(lines_a_band)), abs=0.1)
    assert missed.worst_band_hz[0] == 325.0


def test_a_tone_below_100_hz_is_not_judged(judge: Judge, made: Setup) -> None:
    assert marks(judge, made, tone(95.0, 1.0)).met
    assert not marks(judge, made, tone(105.0, 1.0)).met


def test_distortion_is_energy_above_100_hz_over_the_references(judge: Judge, made: Setup) -> None:
    power = np.mean(made.reference.signal[:, 0] ** 2)
    level = marks(judge, made, tone(310.0, 0.1)).thd_db[0]
    assert level == pytest.approx(10 * np.log10(0.1**2 / 2 / power), abs=0.05)


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_an_overtone_of_a_chirp_is_followed_and_no_other_is_seen(judge: Judge, made: Setup, order: int) -> None:
    analytic = hilbert(made.reference.signal[:, 0])
    swept = 0.01 * np.abs(analytic) * np.sin(order * np.unwrap(np.angle(analytic)))
    levels = marks(judge, made, swept).overtone_db[:, 0]
    others = np.delete(levels, order - 2)
    assert levels[order - 2] == pytest.approx(-40.0, abs=0.3)
    assert others.max() < -65


def test_a_turned_response_has_that_phase_error(judge: Judge, made: Setup) -> None:
    turned = (hilbert(made.reference.signal[:, 0]) * np.exp(0.1j)).real
    phase = marks(judge, made, turned - made.reference.signal[:, 0])
    assert phase.phase_mean[0] == pytest.approx(0.1, abs=1e-3)
    assert phase.phase_peak[0] == pytest.approx(0.1, abs=3e-3)
    assert abs(phase.phase_mean[1]) < 1e-6


def test_headroom_is_the_limit_over_the_largest_sample(judge: Judge, made: Setup) -> None:
    drive = np.array([[4.5, 0.0], [-9.0, 0.9]])
    levels = judge.marks(np.zeros((made.shot.total, 2)), drive).headroom_db
    np.testing.assert_allclose(levels, [0.0, 20.0], atol=1e-9)


def test_a_sine_is_judged_at_its_overtones_alone() -> None:
    made = made_for(f"sine:24:{SECONDS:g}", side=1)
    judge = Judge(made)
    np.testing.assert_allclose(judge.frequency[judge.judged], [48.0, 72.0, 96.0, 120.0])
    response = np.zeros((made.shot.total, 2))
    response[made.shot.window, 0] = made.reference.signal[:, 0] + tone(310.0, 5.0, SECONDS)
    assert judge.marks(response, SILENT).met
    response[made.shot.window, 0] += tone(72.0, 2 * judge.limit[0] / (SECONDS / 2), SECONDS)
    missed = judge.marks(response, SILENT)
    assert missed.worst_line_hz[0] == pytest.approx(72.0)
    assert missed.worst_line_db[0] == pytest.approx(20 * np.log10(2), abs=0.05)
    assert missed.overtone_db[1, 0] == pytest.approx(20 * np.log10(2 * judge.limit[0] / (SECONDS / 2) / 10), abs=0.5)


@pytest.mark.parametrize(
    ("met", "first"),
    [([], None), ([False], None), ([True, False], None), ([True], 0), ([False, True, False, True, True], 3)],
)
def test_the_objective_holds_from_the_first_shot_after_the_last_miss(met: list[bool], first: int | None) -> None:
    assert holds_from(met) == first


def heard_in(judge: Judge, made: Setup, added: np.ndarray, hum: Hum | None = None) -> Marks:
    """Judge the reference with something that is heard during the whole shot, silences and all."""
    response = np.tile(added[:, None], (1, 2))
    response[made.shot.window] += made.reference.signal
    return judge.marks(response, SILENT, hum)


def test_hum_that_is_known_counts_as_heard_but_not_as_emitted(judge: Judge, made: Setup) -> None:
    size = 4 * judge.limit[0] / (JUDGED / 2)
    amplitude = np.zeros((3, 2), complex)
    amplitude[2] = size
    hum = Hum(50.02, amplitude, np.full((3, 2), (0.02 * size) ** 2))
    tones = size * np.cos(2 * np.pi * 150.06 * np.arange(made.shot.total) / RATE)
    assert heard_in(judge, made, tones).verdict == "fail"
    known = heard_in(judge, made, tones, hum)
    assert known.verdict == "pass"
    assert known.worst_line_db.max() < -20
    assert known.heard_line_db.min() == pytest.approx(decibels(4.0), abs=1.0)


def test_hum_that_is_hardly_known_hides_its_lines(judge: Judge, made: Setup) -> None:
    size = 4 * judge.limit[0] / (JUDGED / 2)
    doubt = np.zeros((3, 2))
    doubt[2] = size**2
    tones = size * np.cos(2 * np.pi * 150.06 * np.arange(made.shot.total) / RATE)
    assert heard_in(judge, made, tones, Hum(50.02, np.zeros((3, 2), complex), doubt)).verdict == "hidden"


def test_noise_over_the_limit_hides_what_it_may_explain_and_no_more(judge: Judge, made: Setup) -> None:
    """A line of white noise of rms s has the power s^2 T / rate."""
    noise = np.random.default_rng(5).standard_normal(made.shot.total)
    noise *= 0.8 * judge.limit[0] / np.sqrt(JUDGED / RATE)
    hidden = heard_in(judge, made, noise)
    assert hidden.verdict == "hidden"
    assert not hidden.met
    assert hidden.hidden.min() > 10
    assert hidden.reason.startswith("not judged: over the limit by ")
    loud = np.zeros(made.shot.total)
    loud[made.shot.window] = tone(310.0, 20 * judge.limit[0] / (JUDGED / 2))
    proven = heard_in(judge, made, noise + loud)
    assert proven.verdict == "fail"
    assert proven.worst_line_hz == pytest.approx(310.0)


def test_what_lies_above_the_learned_band_is_judged_all_the_same(judge: Judge, made: Setup) -> None:
    size = 1.4 * judge.limit[0] / (JUDGED / 2)
    assert judge.frequency[judge.judged][[0, -1]] == pytest.approx([100.0, 2000.0])
    for frequency in (655.0, 720.0, 1990.0):
        loud = marks(judge, made, tone(frequency, size))
        assert loud.verdict == "fail"
        assert loud.worst_line_hz[0] == pytest.approx(frequency)
    assert marks(judge, made, tone(1990.0, 0.5 * size)).met


def test_more_noise_makes_no_shot_pass(judge: Judge, made: Setup) -> None:
    loud, verdicts = np.zeros(made.shot.total), []
    loud[made.shot.window] = tone(310.0, 2 * judge.limit[0] / (JUDGED / 2))
    for share in (0.0, 0.1, 0.3, 1.0, 3.0):
        noise = np.random.default_rng(9).standard_normal(made.shot.total)
        verdicts.append(heard_in(judge, made, loud + share * judge.limit[0] / np.sqrt(JUDGED / RATE) * noise).verdict)
    assert verdicts[0] == "fail"
    assert "pass" not in verdicts
    assert verdicts[-1] == "hidden"


def test_noise_under_the_limit_hides_nothing(judge: Judge, made: Setup) -> None:
    noise = np.random.default_rng(6).standard_normal(made.shot.total)
    noise *= 0.1 * judge.limit[0] / np.sqrt(JUDGED / RATE)
    quiet = heard_in(judge, made, noise)
    assert quiet.verdict == "pass"
    assert not quiet.hidden.any()
