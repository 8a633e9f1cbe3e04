"""A run whose objective stands in the far field: learned there or at the shells, resumed, replayed and reported."""

import json
from pathlib import Path

import numpy as np
import pytest
import pyuff
from scipy.io import loadmat

from ctlblocks import recording
from rigkit.run_folder import RunFolder, read_quality
from tests.vibractl.far_field_plant import far_config, far_model_file
from vibractl.export.content import read_content
from vibractl.export.csv import write_csv
from vibractl.export.mat import write_mat
from vibractl.export.uff import write_uff
from vibractl.replay import replay
from vibractl.report import run_report
from vibractl.run_setup import create, setup_of
from vibractl.session import Session

FAR = "learning.sensors=far-field"


def learned(folder: Path, hydrophones: int, shots: int, *overrides: str) -> Path:
    """Run and return the run folder."""
    config = far_config(hydrophones, *overrides)
    run, made = create(folder / "run", config, far_model_file(folder, hydrophones))
    with run:
        session = Session(run, made)
        session.run(shots, lambda *_: None, lambda: False)
        session.summary()
    return folder / "run"


def summary(path: Path) -> dict[str, object]:
    return dict(json.loads((path / "summary.json").read_text()))


@pytest.fixture(scope="module")
def by_two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return learned(tmp_path_factory.mktemp("two"), 2, 5, FAR)


@pytest.fixture(scope="module")
def by_one(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return learned(tmp_path_factory.mktemp("one"), 1, 5, FAR)


def test_two_coils_meet_the_objective_at_two_hydrophones_that_they_learn_from(by_two: Path) -> None:
    figures, last = summary(by_two), read_quality(by_two)[-1]
    assert last["verdict"] == "pass"
    assert figures["judged"] == "far-field"
    assert figures["worst_line_db"] < -5
    assert max(float(last[f"far_error_db_{n}"]) for n in (1, 2)) < -40
    assert "hydrophone" in last["reason"]


@pytest.mark.slow
def test_one_hydrophone_is_satisfied_while_the_shells_are_not(by_one: Path) -> None:
    places = summary(by_one)["places"]
    assert places["far-field"]["objective_met_shot"] is not None
    assert places["accelerometers"]["objective_met_shot"] is None


@pytest.mark.slow
def test_learned_at_the_shells_it_is_judged_in_the_far_field_all_the_same(tmp_path: Path) -> None:
    path = learned(tmp_path, 1, 5)
    figures = summary(path)
    assert figures["judged"] == "far-field"
    assert figures["objective_met_shot"] is not None
    assert figures["places"]["accelerometers"]["objective_met_shot"] is not None


def test_the_objective_may_stand_at_the_shells_while_hydrophones_listen(tmp_path: Path) -> None:
    path = learned(tmp_path, 1, 1, "quality.where=accelerometers")
    row = read_quality(path)[0]
    assert (row["judged"], "response" in row["reason"]) == ("accelerometers", True)
    assert float(row["far_worst_line_db_1"]) != float(row["worst_line_db_1"])
    assert summary(path)["worst_line_db"] == pytest.approx(max(float(row[f"worst_line_db_{n}"]) for n in (1, 2)))


def test_what_was_learned_from_hydrophones_replays_bit_for_bit(by_two: Path) -> None:
    assert all(each.identical for each in replay(by_two, setup_of(by_two)))


@pytest.mark.slow
def test_a_far_field_run_goes_on_where_it_stopped(by_two: Path, tmp_path: Path) -> None:
    path = learned(tmp_path, 2, 3, FAR)
    with RunFolder.open(path) as folder:
        drive = Session(folder, setup_of(path)).learner.drive.astype(np.float32)
    recorded = recording.read(by_two / "shots/0003.wav").select(["drive_1", "drive_2"]).data
    np.testing.assert_array_equal(drive, recorded)


@pytest.mark.slow
def test_the_report_shows_both_places_in_their_units(tmp_path: Path) -> None:
    path = learned(tmp_path, 1, 1, FAR)
    figures = run_report(path)
    page = (path / "report.html").read_text()
    assert figures["judged"] == "far-field"
    for text in ("Objective, -40 dB in the far field", "At the accelerometers, beside that", "IAE of hydrophone 1",
                 "IAE 1, Pa", "1 hydrophone and 2 coils", "2 to 1, mimo"):  # fmt: skip
        assert text in page


def test_the_far_field_is_exported_with_its_delay_and_unit(by_two: Path, tmp_path: Path) -> None:
    content = read_content(by_two, "0")
    assert content.far is not None
    wanted, delay = content.far.response, content.far.delay
    names = [path.name for path in write_csv(tmp_path, content)]
    assert names == ["responses.csv", "far-field.csv", "reference.csv", "shot-0000.csv"]
    head, table = (
        (tmp_path / "far-field.csv").read_text().splitlines()[1].split(","),
        np.loadtxt(tmp_path / "far-field.csv", delimiter=",", skiprows=2),
    )
    real, imaginary = (table[:, head.index(f"T_2_1_{part} [Pa/(m/s^2)]")] for part in ("re", "im"))
    np.testing.assert_allclose(real + 1j * imaginary, wanted[:, 1, 0], rtol=1e-6, atol=1e-8)
    write_mat(tmp_path / "run.mat", content)
    found = loadmat(tmp_path / "run.mat", simplify_cells=True)["run"]["far_field"]
    np.testing.assert_allclose(found["response"], wanted)
    np.testing.assert_array_equal(found["delay"], delay)
    assert found["units"]["response"] == "Pa/(m/s^2)"
    write_uff(tmp_path / "run.uff", content)
    sets = pyuff.UFF(str(tmp_path / "run.uff")).read_sets()
    (one,) = [each for each in sets if each["id1"] == "Frequency response of far_field_2 to response_1"]
    np.testing.assert_allclose(one["data"], wanted[:, 1, 0], rtol=1e-6, atol=1e-8)
    assert (one["ordinate_spec_data_type"], one["orddenom_spec_data_type"]) == (15, 12)
    record = dict(zip(content.shot(0).names, content.shot(0).units, strict=True))
    assert record["far_field_2"] == "Pa"
