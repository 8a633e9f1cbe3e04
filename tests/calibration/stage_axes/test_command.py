"""`calibrate stage` on the simulated stage, at half its rate and in short chirps to be quick."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from calibration.__main__ import main
from calibration.experiment import RawFolder, RawFolderError
from calibration.stage_axes import calibration, order
from calibration.stage_axes.bench import Bench
from calibration.stage_axes.experiment import record
from firmware_sim.plants.piezo_stage import PiezoStagePlant
from rigkit import config as rig_file
from stagectl.config import StageConfig
from stagectl.models.model_file import read_model
from stagectl.stage import design as design_module
from stagectl.stage import design_refinement
from stagectl.stage.design import design
from stagectl.stage.piezo_pid import pid
from stagectl.stage.weights import chosen_weights
from tests.stagectl.experiments.piezo.linear_stage import model as stage_model

RECORDED = ("above-000", "approach-000", "chirp-000", "chirp-001", "chirp-002", "scout-000")
QUICK = ("stage.rate=5000", *(f"characterisation.{text}" for text in ("band=[2, 150]", "seconds=2", "settle=0.5")))


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str | Path, settings: tuple[str, ...] = QUICK) -> int:
    laid_over = [part for text in settings for part in ("--set", text)]
    monkeypatch.setattr(sys, "argv", ["calibrate", "stage", *map(str, arguments), *laid_over])
    return main()


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("calibrated")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(order, "MOST", 5)  # to be quick
        patch.setattr(design_refinement, "LOOKS", 20)
        patch.setattr("rigkit.report._rendered", lambda *_: b"")  # figures are made, not drawn
        arguments = ("--axis", "z", "--json", folder / "f.json", "--png", folder / "png")
        assert call(patch, "--out", folder / "stage-z.h5", *arguments) == 0
    return folder


def test_it_writes_models_report_figures_recordings_and_a_rig_file(calibrated: Path) -> None:
    names = {path.name for path in calibrated.iterdir()}
    models = {"stage-z.h5", "stage-z-open.h5", "stage-z-simo.h5"}
    assert names == {*models, "stage-z.html", "stage-z.toml", "stage-z.raw", "f.json", "png"}
    assert (calibrated / "png" / "z" / "order.png").is_file()
    assert sorted(path.name for path in (calibrated / "stage-z.raw").glob("*.wav")) == [
        *(f"z-closed-{name}.wav" for name in RECORDED),
        *(f"z-open-{name}.wav" for name in RECORDED),
    ]


def test_the_controllers_model_is_at_the_stages_rate_from_reference_to_position(calibrated: Path) -> None:
    model = read_model(calibrated / "stage-z.h5", 5000.0, ["extension_reference_z"], ["position_z"])
    assert model.is_stable
    assert "stage-z.raw" in model.provenance["recording"]
    assert read_model(calibrated / "stage-z-simo.h5").outputs == 3


def test_the_resonance_is_the_plants_and_the_fit_is_good_on_the_fresh_chirp(calibrated: Path) -> None:
    figures = json.loads((calibrated / "f.json").read_text())["z"]
    true = PiezoStagePlant(5000.0).modes
    loudest = true.frequency[np.abs(true.plate[2] * true.extension[2])[true.frequency < 150].argmax()]
    for name in ("open", "closed"):
        assert figures[name]["held_back"]["outputs"]["position_z"]["free_run_nrmse"] > 85
        modes = [mode for mode in figures[name]["modes"] if mode["damping_ratio"] < 0.1]
        assert min(abs(mode["frequency_hz"] / loudest - 1) for mode in modes) < 0.01


def test_the_rig_file_has_the_pid_that_the_loop_was_closed_with(calibrated: Path) -> None:
    figures = json.loads((calibrated / "f.json").read_text())["z"]["inner"]
    rig = rig_file.load(calibrated / "stage-z.toml", StageConfig)
    assert rig.inner.gain[2] == figures["gain"]
    assert rig.inner.bandwidth[2] == figures["bandwidth_hz"]
    assert rig.inner.gain[0] == StageConfig().inner.gain[0]
    assert figures["max_sensitivity"] <= 2.2


def test_the_rig_file_has_the_outer_loop_that_a_run_is_to_use(calibrated: Path) -> None:
    figures = json.loads((calibrated / "f.json").read_text())["z"]["outer"]
    rig = rig_file.load(calibrated / "stage-z.toml", StageConfig)
    model = read_model(calibrated / "stage-z.h5")
    chosen = chosen_weights(rig.weights, 2)
    assert chosen is not None
    made = design(model, rig.outer, 2, chosen)
    assert made.robustness.max_sensitivity == pytest.approx(figures["max_sensitivity"], rel=1e-6)
    assert made.robustness.max_sensitivity <= 2.2
    assert made.left == pytest.approx(figures["left"], rel=1e-6)
    assert made.beyond == pytest.approx(figures["beyond"], rel=1e-6)
    assert chosen_weights(rig.weights, 0) is None  # not calibrated


@pytest.mark.slow
def test_a_model_without_an_outer_loop_is_told_of_with_the_values(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design_module, "NOTCHES", ())  # which are none the better, and take as long again
    rig = rig_file.load(None, StageConfig, ["outer.beyond=[1e-6]"])
    why = calibration.outer_loop(rig.outer, 2, stage_model("z"))
    assert isinstance(why, str)
    assert re.search(
        r"axis 3: none of \d+ outer loops meets its bounds; binding is the controller's gain above outer\.reach: "
        r"calibrate with a wider characterisation\.band .*; the nearest has gains .* of those allowed.*; "
        r"allowed are Ms 2\.2, ",
        why,
    )
    assert "\n" not in why


def test_the_rig_files_own_pid_is_judged_and_kept_where_it_is_asked_for() -> None:
    rig = rig_file.load(None, StageConfig, ["characterisation.inner=rig"])
    loop, inner, figures = calibration.inner_loop(rig, 1, stage_model("y"))
    assert loop == pid(rig.inner, 1)
    assert (inner.gain[0], inner.bandwidth[0]) == (rig.inner.gain[0], rig.inner.bandwidth[0])
    assert not figures.stable  # a plate's resonances in place of a stack's


def test_what_is_recorded_is_not_recorded_again(calibrated: Path) -> None:
    rig = rig_file.load(None, StageConfig, QUICK)
    files = sorted((calibrated / "stage-z.raw").glob("z-open-*.wav"))
    times = [path.stat().st_mtime_ns for path in files]
    with RawFolder(calibrated / "stage-z.raw") as raw:
        found = record(Bench(rig, 2, None, lambda: True), raw)  # that bench would stop at once
    assert [path.stat().st_mtime_ns for path in files] == times
    assert [len(part.drive) for part in found.learned] == [10_000, 11_500]


def test_recordings_of_other_settings_are_refused(calibrated: Path) -> None:
    rig = rig_file.load(None, StageConfig, [*QUICK, "simulator.options.seed=2"])
    with RawFolder(calibrated / "stage-z.raw") as raw, pytest.raises(RawFolderError, match="seed"):
        record(Bench(rig, 2, None, lambda: False), raw)


@pytest.mark.parametrize(
    ("arguments", "settings", "words"),
    [
        (("--out", "m.txt"), QUICK, "must be '.h5'"),
        (("--out", "m.h5", "--axis", "w"), QUICK, "must be x, y, z or all"),
        (("--out", "m.h5", "--order", "99"), QUICK, "--order is 99, must be 1 to 14"),
        (("--out", "m.h5", "--method", "pem"), QUICK, "must be moesp or n4sid"),
        (("--out", "m.h5"), ("characterisation.seconds=2",), "characterisation.seconds is 2 s, must be >= 4 s"),
        (("--out", "m.h5"), ("characterisation.band=[30, 200]",), "span a decade"),
    ],
)
def test_bad_input_is_one_line_and_status_2_and_writes_nothing(
    arguments: tuple[str, ...],
    settings: tuple[str, ...],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert call(monkeypatch, *arguments, settings=settings) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_an_excitation_that_the_guard_stops_says_what_to_lower(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    settings = (*QUICK, "characterisation.scout=600")
    assert call(monkeypatch, "--out", tmp_path / "m.h5", "--axis", "z", settings=settings) == 2
    assert "lower characterisation.excursion or characterisation.scout" in capsys.readouterr().err
    assert not (tmp_path / "m.h5").exists()
