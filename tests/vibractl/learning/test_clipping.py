from collections.abc import Callable

import numpy as np
import pytest

from tests.vibractl.learning.line_plant import modal
from vibractl.learning.clipping import Clipping, Cut, found_cut

RATE, FRAMES = 8_000.0, 8_000
LOOKED_AT = np.arange(100, 650)
TIME = np.arange(FRAMES) / RATE
SWEEP = np.sin(2 * np.pi * (40 * TIME + 25 * TIME**2))
DRIVE = np.column_stack([3.0 * SWEEP, 2.0 * np.roll(SWEEP, 400)])
G = modal(2, 2)[LOOKED_AT - 14]


def heard(signal: np.ndarray) -> np.ndarray:
    lines = np.fft.rfft(signal, axis=0)[LOOKED_AT] / RATE
    answer: np.ndarray = (G @ lines[..., None])[..., 0]
    return answer


def noise(part: float, seed: int = 1) -> np.ndarray:
    """Return noise of so large a part of what a cut at 2.4 V leaves out."""
    rng = np.random.default_rng(seed)
    lines = rng.standard_normal((len(LOOKED_AT), 2)) + 1j * rng.standard_normal((len(LOOKED_AT), 2))
    size = np.linalg.norm(heard(np.clip(DRIVE, -2.4, 2.4) - DRIVE))
    return part * size / np.linalg.norm(lines) * lines


@pytest.mark.parametrize("level", [2.9, 2.4, 1.5])
def test_the_level_of_an_amplifier_is_found_in_noise(level: float) -> None:
    found = found_cut(DRIVE, heard(np.clip(DRIVE, -level, level) - DRIVE) + noise(0.02), heard)
    assert found is not None
    assert found.level == pytest.approx(level, rel=0.03)
    assert found.share > 0.4


def test_the_coil_is_named() -> None:
    cut = DRIVE.copy()
    cut[:, 1] = np.clip(cut[:, 1], -1.5, 1.5)
    found = found_cut(DRIVE, heard(cut - DRIVE), heard)
    assert found is not None
    assert found.coils == (1,)
    assert found.level == pytest.approx(1.5, rel=0.03)


DISTORTED: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "a spring that stiffens": lambda drive: -0.02 * drive**3,
    "a spring that softens": lambda drive: 0.02 * drive**3,
    "an even one": lambda drive: 0.05 * drive**2,
    "friction": lambda drive: (
        -0.2 * np.tanh(20 * np.gradient(drive, axis=0) / np.abs(np.gradient(drive, axis=0)).max())
    ),
    "play": lambda drive: -0.2 * np.tanh(3 * drive),
}


@pytest.mark.parametrize("kind", DISTORTED)
def test_what_distorts_otherwise_is_no_cut(kind: str) -> None:
    assert found_cut(DRIVE, heard(DISTORTED[kind](DRIVE)), heard) is None


def test_noise_alone_and_silence_are_no_cut() -> None:
    assert all(found_cut(DRIVE, noise(1.0, seed), heard) is None for seed in range(20))
    assert found_cut(np.zeros_like(DRIVE), noise(1.0), heard) is None
    assert found_cut(DRIVE, np.zeros((len(LOOKED_AT), 2), complex), heard) is None


def test_it_is_told_once_when_two_shots_agree() -> None:
    clipping = Clipping()
    assert [clipping.take(cut) for cut in (Cut((0,), 2.0, 0.9), None, Cut((0,), 2.6, 0.9), Cut((1,), 2.6, 0.9))] == [
        None
    ] * 4
    assert not clipping.text
    told = Cut((1,), 2.5, 0.8)
    assert clipping.take(told) is told
    assert clipping.text.startswith("drive 2 is cut off at about 2.5 V")
    assert clipping.take(Cut((1,), 2.5, 0.8)) is None
    assert clipping.text
