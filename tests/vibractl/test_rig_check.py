"""A run begins with a weak burst, and goes no further on a rig whose channels are not those of its model."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ctlblocks import recording
from rigkit.faults import FaultTable
from rigkit.run_folder import RunFolder, read_events
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.learning.shot import Shot
from vibractl.rig_check import LEVEL_DB, ChangedRigError, RigCheck, changed_channels
from vibractl.run_setup import create, resumed_setup, shot_files
from vibractl.session import Session
from vibractl.setup import Setup
from vibractl.shot_file import DISCARDED
from vibractl.supervision import Supervision, input_names


def begun(place: Path, *settings: str) -> tuple[RunFolder, Setup]:
    return create(place / "run", linear_config(*settings), linear_model(place))


def go(folder: RunFolder, made: Setup, shots: int, kind: str = "none", accept: tuple[str, ...] = ()) -> Session:
    """Run so many shots with a fault of the second accelerometer."""
    table = FaultTable(input_names(made.config.audio))
    table.inject("response_2", kind)
    session = Session(folder, made, Supervision(faults=table), accept)
    session.run(shots, lambda *_: None, lambda: False)
    return session


def test_the_burst_is_weak_within_the_band_and_another_signal_on_every_coil(tmp_path: Path) -> None:
    folder, made = begun(tmp_path)
    with folder:
        drive = made.learner().drive
        burst = RigCheck.of(made, drive).drive
    size = [float(np.sqrt(np.mean(np.square(each), axis=0)).max()) for each in (burst.astype(float), drive)]
    assert 20 * np.log10(size[0] / size[1]) == pytest.approx(LEVEL_DB, abs=0.1)
    lines = np.abs(np.fft.rfft(burst.astype(float), axis=0)) ** 2
    frequency = np.fft.rfftfreq(len(burst), 1 / 44_100)
    outside = lines[(frequency < 38) | (frequency > 92)].sum() / lines.sum()
    assert outside < 1e-3
    assert abs(np.corrcoef(burst.T)[0, 1]) < 0.2
    assert np.array_equal(burst[[0, -1]], np.zeros((2, 2)))


def test_a_rig_as_calibrated_is_said_to_be_so_and_learns(tmp_path: Path) -> None:
    folder, made = begun(tmp_path)
    with folder:
        assert go(folder, made, 1).done == 1
    checked = [event for event in read_events(tmp_path / "run") if event["event"] == "checked"]
    assert [(each["shot"], each["change"]) for each in checked] == [(0, "")]
    assert checked[0]["off"] < 0.05  # the model is exact


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("sign-flip", "response 2 is turned round (its polarity)"),
        ("delay", "response 2 comes 10.1 ms late"),
        ("x10", "response 2 is 10 times as large"),
    ],
)
def test_a_rig_that_was_changed_is_refused_before_anything_is_learned_until_it_is_accepted(
    tmp_path: Path, kind: str, text: str
) -> None:
    folder, made = begun(tmp_path)
    with folder, pytest.raises(ChangedRigError) as refused:
        go(folder, made, 2, kind)
    assert f"run/: this is not the rig that was calibrated: {text}" in str(refused.value)
    assert "--accept channels" in str(refused.value)
    assert shot_files(tmp_path / "run") == []
    heard = recording.read(next((tmp_path / "run" / DISCARDED).glob("*.wav")))
    assert np.abs(heard.select(["response_2"]).data).max() > 0
    with RunFolder.open(tmp_path / "run") as again:
        session = go(again, resumed_setup(again, ["channels"]), 1, kind, ("channels",))
        assert (session.done, session.note) == (1, "")
    assert [event["event"] for event in read_events(tmp_path / "run")].count("checked") == 2


def test_sensors_that_were_exchanged_are_found(tmp_path: Path) -> None:
    folder, made = begun(tmp_path)
    with folder:
        check = RigCheck.of(made, made.learner().drive)
        both = (check.response @ check.lines[..., None])[..., 0]
        whole = np.zeros((len(check.drive) // check.step // 2 + 1, 2), complex)
        whole[check.inside] = both[:, ::-1]
        heard = np.repeat(np.fft.irfft(whole, len(check.drive) // check.step, axis=0), check.step, axis=0)
    off, _, change = check.judge(heard)
    assert off > 0.5
    assert change is not None
    assert "response 1 is where response 2 was; response 2 is where response 1 was" in change.text


def test_a_sensor_that_turns_round_while_it_learns_ends_the_run_before_it_is_learned_from(tmp_path: Path) -> None:
    folder, made = begun(tmp_path)
    table = FaultTable(input_names(made.config.audio))
    with folder:
        session = Session(folder, made, Supervision(faults=table))
        with pytest.raises(ChangedRigError, match=r"run/, shot 2: .*response 2 is turned round"):
            session.run(5, lambda shot, _: table.inject("response_2", ("none", "sign-flip")[shot]), lambda: False)
    assert [file.name for file in shot_files(tmp_path / "run")] == ["0000.wav", "0001.wav"]
    assert [file.name for file in (tmp_path / "run" / DISCARDED).iterdir()] == ["0002-000.wav"]
    with RunFolder.open(tmp_path / "run") as again:  # put right, it goes on where it was
        assert go(again, resumed_setup(again), 4).done == 4


def test_nothing_is_played_after_a_stop_that_came_while_the_stream_was_opened(tmp_path: Path) -> None:
    folder, made = begun(tmp_path)
    with folder:
        session = Session(folder, made)
        session.run(1, lambda *_: None, lambda: True)
    assert session.done == 0
    assert "checked" not in [event["event"] for event in read_events(tmp_path / "run")]


def test_nothing_is_played_or_refused_where_nobody_wants_to_know(tmp_path: Path) -> None:
    folder, made = begun(tmp_path, "session.check=false")
    with folder:
        assert go(folder, made, 2, "sign-flip").done == 2
    assert "checked" not in [event["event"] for event in read_events(tmp_path / "run")]


RNG = np.random.default_rng(1)
BELIEVED, DRIVE = (RNG.standard_normal((80, 2, each)) + 1j * RNG.standard_normal((80, 2, each)) for each in (2, 1))
LAW = SimpleNamespace(
    reference=np.ones((80, 2)), active=np.ones(80), matrix=SimpleNamespace(frequency=np.linspace(40.0, 90.0, 80))
)


def heard_as(factor: float | np.ndarray) -> Shot:
    """Return a shot whose response is what is believed of G, times a factor."""
    return Shot(DRIVE[..., 0], factor * (BELIEVED @ DRIVE)[..., 0], np.ones((80, 2)))


def test_a_sensor_that_turns_round_within_a_shot_is_named_at_the_next() -> None:
    """The shot itself has both, which nothing explains; the next is no further off than that."""
    torn = np.where(np.arange(80)[:, None] % 2, [1.0, 1.0], [1.0, -1.0]) * np.exp(0.7j * RNG.standard_normal((80, 2)))
    algorithm: Any = SimpleNamespace(law=LAW, belief=SimpleNamespace(response=BELIEVED, before=None))
    usual, change = changed_channels(algorithm, heard_as(torn), 0.1)
    assert (usual, change) == (0.1, None)
    algorithm.belief.before = heard_as(torn)
    turned = heard_as(np.array([1.0, -1.0]))
    assert changed_channels(algorithm, turned) == (None, None)
    usual, change = changed_channels(algorithm, turned, usual)
    assert usual is None
    assert change is not None
    assert change.text.startswith("response 2 is turned round")


@pytest.mark.parametrize(("earlier", "said"), [(1.0, "every drive is 1.6 times as large"), (1.4, None)])
def test_what_comes_by_and_by_is_no_change_of_the_channels(earlier: float, said: str | None) -> None:
    """A machine that drifts, or distorts more and more, ends where a gain that was changed does, and is to go on."""
    before, now = (heard_as(earlier), heard_as(1.6))
    algorithm: Any = SimpleNamespace(law=LAW, belief=SimpleNamespace(response=BELIEVED, before=before))
    _, found = changed_channels(algorithm, now)
    assert (found and found.text.split(", or: ")[0]) == said


@pytest.mark.parametrize(("earlier", "is_changed"), [(1.0, False), (1.3, False), (-1.0, True)])
def test_a_response_like_the_one_before_is_of_the_same_channels_whatever_is_believed(
    earlier: float, is_changed: bool
) -> None:
    """An accelerometer with a clock of its own makes a poor G, by which the channels would seem to be exchanged."""
    belief = SimpleNamespace(response=BELIEVED[:, ::-1], before=heard_as(earlier))
    algorithm: Any = SimpleNamespace(law=LAW, belief=belief)
    usual, change = changed_channels(algorithm, heard_as(1.0), 0.1)
    assert (change is not None) == is_changed
    assert usual == (None if is_changed else 0.1)
