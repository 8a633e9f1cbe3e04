"""References: what is asked for is what comes, and what cannot be is refused by name."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import soundfile

from ctlblocks import recording
from ctlblocks.recording import Recording
from vibractl.reference import Reference, is_one_tone, reference_from, sweep_of
from vibractl.reference_forms import FORMS, Form, choices

RATE = 44_100.0


def made(text: str, outputs: int = 2) -> Reference:
    """Return the reference with an amplitude of 10 m/s^2 and a taper of 4 %."""
    return reference_from(text, RATE, 10.0, 0.04, outputs, 4)


def wav(path: Path, data: np.ndarray, rate: float = RATE) -> str:
    """Write a WAV file and return its name."""
    names = tuple(f"reference_{n}" for n in range(data.shape[1]))
    recording.write(path, Recording(names, ("m/s^2",) * len(names), rate, data))
    return str(path)


def test_a_chirp_sweeps_from_its_first_to_its_last_frequency() -> None:
    signal = made("chirp:40:90:5").signal
    assert signal.shape == (220_500, 2)
    crossings = np.flatnonzero(np.diff(np.signbit(signal[:, 0])))
    local = RATE / (2 * np.diff(crossings))
    assert local[2] == pytest.approx(40, rel=0.02)
    assert local[-3] == pytest.approx(90, rel=0.02)
    assert np.abs(signal).max() == pytest.approx(10.0, rel=1e-3)
    assert signal[0, 0] == 0.0


def test_a_sine_has_a_root_that_fits_its_length() -> None:
    assert made("sine:24:5").root == 24.0
    with pytest.raises(ValueError, match=r"24.1 Hz is no multiple of 1/5 s; the nearest is 24"):
        made("sine:24.1:5")


def test_a_file_of_one_channel_serves_all_sides(tmp_path: Path) -> None:
    data = np.random.default_rng(1).standard_normal((6_001, 1)).astype(np.float32)
    signal = made(wav(tmp_path / "r.wav", data)).signal
    assert signal.shape == (6_004, 2)
    np.testing.assert_array_equal(signal[:6_001, 1], data[:, 0])
    assert not signal[6_001:].any()


def test_a_wav_of_integers_needs_a_full_scale(tmp_path: Path) -> None:
    path = tmp_path / "r.wav"
    soundfile.write(path, np.full((6_000, 1), 0.5), int(RATE), "PCM_16")
    with pytest.raises(ValueError, match=r"r.wav: an integer WAV has no unit; reference.full_scale must state"):
        reference_from(str(path), RATE, 10.0, 0.0, 2, 4)
    signal = reference_from(str(path), RATE, 10.0, 0.0, 2, 4, full_scale=20.0).signal
    np.testing.assert_allclose(signal[:6_000], 10.0)


def test_a_csv_file_of_one_channel_a_side_serves_each(tmp_path: Path) -> None:
    data = np.random.default_rng(1).standard_normal((6_000, 2))
    np.testing.assert_array_equal(made(wav(tmp_path / "r.csv", data)).signal, data)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("chirp:40:90", "'chirp:40:90' is not chirp:F0:F1:SECONDS"),
        ("chirp:40:x:5", "is not chirp:F0:F1:SECONDS"),
        ("chirp:-40:90:5", "F0 is -40 Hz, must be above 0 and below 22050"),
        ("chirp:40:nan:5", "F1 is nan Hz"),
        ("chirp:40:90:500", "SECONDS is 500, must be 0.1 to 60"),
        ("sine:24:inf", "SECONDS is inf"),
        ("noise:3", "'noise:3' is not chirp"),
        ("absent.wav", "absent.wav"),
    ],
)
def test_what_is_no_reference_is_refused(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        made(text)


def test_an_unusable_file_is_refused_with_what_it_should_be(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).standard_normal((6_000, 3))
    with pytest.raises(ValueError, match="48000 samples/s, must be audio.rate, 44100"):
        made(wav(tmp_path / "a.wav", noise[:, :1], 48_000))
    with pytest.raises(ValueError, match="3 channels, must be 1 or 2 channels"):
        made(wav(tmp_path / "b.wav", noise))
    with pytest.raises(ValueError, match="2 channels, must be 1 channel"):
        made(wav(tmp_path / "c.wav", noise[:, :2]), outputs=1)
    with pytest.raises(ValueError, match="must be 0.1 to 60 s"):
        made(wav(tmp_path / "d.wav", noise[:100, :1]))
    with pytest.raises(ValueError, match="silent"):
        made(wav(tmp_path / "e.wav", 0 * noise[:, :1]))


def test_a_new_form_is_a_function_and_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(FORMS, "beat", Form(("F0", "F1", "SECONDS"), _beat))
    made = reference_from("beat:40:43:2", 44_100.0, 10.0, 0.0, 2, 20)
    assert made.root is None
    assert made.signal[:, 1] == pytest.approx(10.0 * _beat(np.arange(88_200) / 44_100.0, (40.0, 43.0, 2.0)))
    assert "beat:F0:F1:SECONDS" in choices("a file")
    assert not is_one_tone(made.text)
    assert sweep_of(made.text) is None
    with pytest.raises(ValueError, match=r"'beat:40' is not beat:F0:F1:SECONDS"):
        reference_from("beat:40", 44_100.0, 10.0, 0.0, 1, 20)


@pytest.mark.parametrize(
    ("text", "one_tone", "sweep"),
    [("chirp:90:40.5:5", True, (90.0, 40.5)), ("sine:24:5", True, (24.0, 24.0)), ("a:b/chirp.WAV", False, None)],
)
def test_a_form_says_whether_it_is_one_tone_and_what_it_sweeps(
    text: str, one_tone: bool, sweep: tuple[float, float] | None
) -> None:
    assert (is_one_tone(text), sweep_of(text)) == (one_tone, sweep)


def _beat(time: np.ndarray, numbers: Sequence[float]) -> np.ndarray:
    return np.asarray(np.mean([np.sin(2 * np.pi * each * time) for each in numbers[:2]], axis=0))
