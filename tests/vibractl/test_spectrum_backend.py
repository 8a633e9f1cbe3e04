"""The library that transforms: either serves, a run says which, and is replayed bit for bit by that one alone."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rigkit import config as rig_file
from rigkit.run_folder import CONFIG
from tests.until import EVER
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl import fft_transform
from vibractl.config import RigConfig
from vibractl.fft_command import plan_command
from vibractl.fft_plans import Plans
from vibractl.fft_transform import Transform
from vibractl.replay import replay
from vibractl.run_setup import WISDOM, create, settings_of, setup_of
from vibractl.session import Session

WITHOUT = "import sys; sys.modules['pyfftw'] = None; from vibractl.__main__ import main; sys.argv = {words!r}; main()"


@pytest.fixture
def without_fftw(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fft_transform, "pyfftw", None)


def run_of(folder: Path, *overrides: str) -> Path:
    made_folder, made = create(folder / "run", linear_config(*overrides), linear_model(folder))
    with made_folder:
        Session(made_folder, made).run(2, lambda *_: None, lambda: False)
    return folder / "run"


@pytest.mark.parametrize("frames", [504, 505, 2 * 2_503])
def test_both_transform_alike(frames: int) -> None:
    signal = np.random.default_rng(1).standard_normal((2, frames))
    bins = {}
    for backend in ("fftw", "scipy"):
        fft = Plans(backend=backend).planned(Transform(frames, 2))
        fft.time[:] = signal
        fft.forward()
        bins[backend] = fft.bins.copy()
        fft.backward()
        np.testing.assert_allclose(fft.time / frames, signal, rtol=0, atol=1e-12)
    np.testing.assert_allclose(bins["scipy"], bins["fftw"], rtol=0, atol=1e-12 * np.abs(bins["fftw"]).max())


@pytest.mark.parametrize("backend", ["fftw", "scipy"])
def test_a_run_says_which_it_was_made_with_and_is_replayed_by_it(backend: str, tmp_path: Path) -> None:
    path = run_of(tmp_path, f"spectrum.backend={backend}")
    assert rig_file.load(path / CONFIG, RigConfig).spectrum.backend == backend
    assert (path / WISDOM).exists() == (backend == "fftw")
    made = setup_of(path)
    assert (made.plans.library, made.plans.note) == (backend, "")
    assert all(each.identical for each in replay(path, made))


def test_where_nothing_is_said_fftw_is_taken_and_named(tmp_path: Path) -> None:
    folder, _ = create(tmp_path / "run", linear_config(), linear_model(tmp_path))
    folder.close()
    assert rig_file.load(tmp_path / "run" / CONFIG, RigConfig).spectrum.backend == "fftw"


def test_a_run_from_before_there_was_a_choice_is_fftws(tmp_path: Path) -> None:
    folder, _ = create(tmp_path / "run", linear_config(), linear_model(tmp_path))
    folder.close()
    text = (tmp_path / "run" / CONFIG).read_text()
    (tmp_path / "run" / CONFIG).write_text(text.replace('[spectrum]\nbackend = "fftw"', ""))
    assert "[spectrum]" not in (tmp_path / "run" / CONFIG).read_text()
    assert settings_of(tmp_path / "run").spectrum.backend == "fftw"


@pytest.mark.usefixtures("without_fftw")
def test_without_fftw_scipy_is_taken_and_named(tmp_path: Path) -> None:
    path = run_of(tmp_path)
    assert rig_file.load(path / CONFIG, RigConfig).spectrum.backend == "scipy"
    assert all(each.identical for each in replay(path, setup_of(path)))


def test_without_fftw_a_run_that_was_made_with_it_is_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, _ = create(tmp_path / "run", linear_config(), linear_model(tmp_path))
    folder.close()
    monkeypatch.setattr(fft_transform, "pyfftw", None)
    with pytest.raises(ValueError, match="spectrum.backend is fftw, but pyfftw is not installed"):
        setup_of(tmp_path / "run")


def test_scipy_has_no_plans_to_measure() -> None:
    with pytest.raises(ValueError, match="SciPy's FFTs have no plans to measure"):
        plan_command(settings=["spectrum.backend=scipy"])


@pytest.mark.slow
def test_a_shot_is_learned_where_pyfftw_cannot_be_imported(tmp_path: Path) -> None:
    """As a program whose environment lacks it; the audio's process is another one and imports it neither."""
    model = linear_model(tmp_path)
    words = ["vibractl", "run", "--model", str(model), "--reference", "chirp:40:90:1", "--shots", "2"]
    words += ["--set", "audio.isolated=false", "--out", str(tmp_path / "run")]
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT.format(words=words)], capture_output=True, text=True, timeout=EVER, check=False
    )
    assert done.returncode == 0, done.stderr
    assert rig_file.load(tmp_path / "run" / CONFIG, RigConfig).spectrum.backend == "scipy"
    assert not (tmp_path / "run" / WISDOM).exists()
