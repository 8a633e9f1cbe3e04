"""FFT plans: none is measured before a shot, a run keeps its own, and whatever is wrong with them it goes on."""

from pathlib import Path
from typing import Any

import numpy as np
import pyfftw
import pytest

from tests.vibractl.far_field_plant import far_config, far_model_file
from tests.vibractl.linear_rig import linear_config, linear_matrix, linear_model
from tests.vibractl.test_session import run
from vibractl.config import RigConfig
from vibractl.fft_plans import Plans, user_wisdom
from vibractl.fft_transform import Transform
from vibractl.replay import replay
from vibractl.run_setup import WISDOM, create, setup_of
from vibractl.session import Session
from vibractl.setup import setup

SIZE = Transform(504, 2)
SHORT = "reference.signal=chirp:40:90:0.2"


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give this user an empty cache folder."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def flags(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Collect the flags that FFTW plans by."""
    seen: list[str] = []

    class Noted(pyfftw.FFTW):  # type: ignore[misc]
        def __new__(cls, *args: Any, **keywords: Any) -> Any:
            seen.extend(keywords["flags"])
            return super().__new__(cls, *args, **keywords)

    monkeypatch.setattr(pyfftw, "FFTW", Noted)
    return seen


def known(wisdom: bytes) -> set[bytes]:
    """Return the plans in a wisdom, which FFTW writes in any order."""
    return set(wisdom.splitlines())


def transformed(plans: Plans, size: Transform = SIZE) -> bytes:
    """Return the bits of a random signal's transform, and of that one's inverse."""
    fft = plans.planned(size)
    fft.time[:] = np.random.default_rng(1).standard_normal(fft.time.shape)
    fft.forward()
    there = fft.bins.tobytes()
    fft.backward()
    return there + fft.time.tobytes()


def test_no_plan_is_measured_before_the_last_shot_of_a_run(tmp_path: Path, flags: list[str]) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 2)
    assert "FFTW_ESTIMATE" in flags
    assert not {"FFTW_MEASURE", "FFTW_PATIENT", "FFTW_EXHAUSTIVE"} & set(flags)


@pytest.mark.parametrize("frames", [5_040, 5_039, 2 * 2_503])
def test_an_estimate_transforms_exactly_lengths_with_large_primes_too(frames: int) -> None:
    fft = Plans().planned(Transform(frames, 2))
    signal = np.random.default_rng(1).standard_normal((2, frames))
    fft.time[:] = signal
    fft.forward()
    np.testing.assert_allclose(fft.bins, np.fft.rfft(signal), rtol=0, atol=1e-12 * np.abs(fft.bins).max())
    fft.backward()
    np.testing.assert_allclose(fft.time / frames, signal, rtol=0, atol=1e-12)


def test_estimates_are_the_same_in_every_run() -> None:
    assert transformed(Plans()) == transformed(Plans())


def test_a_measured_plan_is_taken_as_it_is_wherever_its_wisdom_is() -> None:
    measured = Plans()
    measured.planned(SIZE, "FFTW_MEASURE")
    later = Plans(measured.wisdom)
    assert transformed(later) == transformed(measured)
    assert known(later.wisdom) == known(measured.wisdom)  # nothing was planned anew


def test_runs_do_not_see_each_others_plans() -> None:
    one, other = Plans(), Plans()
    one.planned(SIZE)
    other.planned(Transform(693, 1))
    one.planned(SIZE)
    assert known(one.wisdom).isdisjoint(known(other.wisdom) - known(Plans().wisdom))


@pytest.mark.slow
@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "overrides",
    [(), ("learning.side=1",), ("learning.structure=common",), ("learning.decimation=1",)],
    ids=lambda overrides: " ".join(overrides) or "as it is",
)
def test_the_folder_holds_every_plan_of_its_run(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    _holds_every_plan(tmp_path, linear_config(*overrides), linear_model(tmp_path))


@pytest.mark.sample(1)
@pytest.mark.parametrize("sensors", ["accelerometers", "far-field"])
def test_the_folder_holds_every_plan_of_a_run_with_hydrophones(tmp_path: Path, sensors: str) -> None:
    config = far_config(1, f"learning.sensors={sensors}")
    _holds_every_plan(tmp_path, config, far_model_file(tmp_path, 1))


def _holds_every_plan(tmp_path: Path, config: RigConfig, model: Path) -> None:
    folder, made = create(tmp_path / "run", config, model)
    with folder:
        stored = (folder.path / WISDOM).read_bytes()
        Session(folder, made).run(1, lambda *_: None, lambda: False)
    assert known(made.plans.wisdom) == known(stored)
    again = setup_of(tmp_path / "run")
    again.learner()
    assert known(again.plans.wisdom) == known(stored)


def test_a_run_takes_what_its_user_has_measured_and_keeps_it(tmp_path: Path) -> None:
    config, measured = linear_config("learning.decimation=1", SHORT, "learning.side=1"), Plans()
    measured.planned(Transform(26_460, 1), "FFTW_MEASURE")
    user_wisdom().parent.mkdir(parents=True)
    user_wisdom().write_bytes(measured.wisdom)
    folder, _ = create(tmp_path / "run", config, linear_model(tmp_path))
    folder.close()
    user_wisdom().unlink()
    assert known(setup_of(tmp_path / "run").plans.wisdom) == known(measured.wisdom)


def test_other_plans_of_the_user_change_nothing_in_a_run_under_way() -> None:
    made = setup(linear_config(SHORT, "learning.side=1"), linear_matrix())
    first, before = made.learner().lines.tobytes(), known(made.plans.wisdom)
    user_wisdom().parent.mkdir(parents=True)
    other = Plans()
    other.planned(Transform(26_460, 1), "FFTW_MEASURE")
    user_wisdom().write_bytes(other.wisdom)
    setup(linear_config("reference.signal=chirp:40:90:0.4"), linear_matrix(), plans=Plans.of_user())
    assert made.learner().lines.tobytes() == first
    assert known(made.plans.wisdom) == before


@pytest.mark.sample(2)
@pytest.mark.parametrize("fault", ["a file for a folder", "no permission", "damaged", "cut off"])
def test_a_cache_that_cannot_be_read_is_no_obstacle_to_a_run(
    tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    spoil(cache, fault, monkeypatch)
    run(tmp_path / "run", linear_model(tmp_path), 1)
    assert all(each.identical for each in replay(tmp_path / "run", setup_of(tmp_path / "run")))


def spoil(cache: Path, fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the user's plans into a state in which nothing can be had from them."""
    if fault == "a file for a folder":
        cache.mkdir()
        (cache / "vibrostage").write_text("not a folder")
        return
    measured = Plans()
    measured.planned(SIZE)
    path = user_wisdom()
    path.parent.mkdir(parents=True)
    path.write_bytes({"damaged": b"(not wisdom", "cut off": measured.wisdom[:-200]}.get(fault, measured.wisdom))
    if fault == "no permission":
        read = Path.read_bytes

        def refused(self: Path) -> bytes:
            if self == path:
                raise PermissionError(13, "Permission denied", str(self))
            return read(self)

        monkeypatch.setattr(Path, "read_bytes", refused)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, "No such file or directory"),
        (b"(fftw-3.3.5 fftw_wisdom #x1 #x2 #x3 #x4\n)\n", "damaged, or from another"),
    ],
)
def test_a_replay_without_its_plans_says_so_and_estimates(tmp_path: Path, content: bytes | None, reason: str) -> None:
    run(tmp_path / "run", linear_model(tmp_path), 1)
    stored = tmp_path / "run" / WISDOM
    assert setup_of(tmp_path / "run").plans.note == ""
    stored.unlink()
    if content is not None:
        stored.write_bytes(content)
    made = setup_of(tmp_path / "run")
    assert made.plans.note.startswith(f"{stored}: {reason}")
    assert max(each.difference for each in replay(tmp_path / "run", made)) < 1e-5
