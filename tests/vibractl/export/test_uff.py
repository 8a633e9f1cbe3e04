"""A run as dataset 58, read back by pyuff, and beside files that other programs wrote."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff

from tests.vibractl.export.exported_run import REAL, recorded_run, with_pressure
from vibractl.export.content import Content, read_content
from vibractl.export.uff import auto_spectrum, write_uff


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return read_content(recorded_run(tmp_path_factory.mktemp("run")))


@pytest.fixture(scope="module")
def sets(content: Content, tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    path = tmp_path_factory.mktemp("uff") / "run.uff"
    write_uff(path, content)
    read: list[dict[str, Any]] = pyuff.UFF(str(path)).read_sets()
    return read


def of_kind(sets: list[dict[str, Any]], kind: int, what: str = "") -> list[dict[str, Any]]:
    return [each for each in sets if each["func_type"] == kind and what in each["id1"]]


def test_every_element_of_the_model_comes_back_with_its_degrees_of_freedom(
    content: Content, sets: list[dict[str, Any]]
) -> None:
    found = of_kind(sets, 4)
    assert sorted((each["rsp_node"], each["ref_node"]) for each in found) == [(1, 1), (1, 2), (2, 1), (2, 2)]
    for each in found:
        wanted = content.matrix.response[:, each["rsp_node"] - 1, each["ref_node"] - 1]
        np.testing.assert_allclose(each["data"], wanted, rtol=1e-7)
        np.testing.assert_allclose(each["x"], content.matrix.frequency, rtol=5e-6)  # E13.5 of the format
        assert (each["rsp_ent_name"], each["ref_ent_name"]) == ("RESPONSE", "DRIVE")
        assert (each["ordinate_axis_units_lab"], each["orddenom_axis_units_lab"]) == ("m/s^2", "V")
        assert (each["ordinate_spec_data_type"], each["abscissa_spec_data_type"]) == (12, 18)


def test_every_element_has_its_coherence(content: Content, sets: list[dict[str, Any]]) -> None:
    found = of_kind(sets, 6)
    assert len(found) == 4
    for each in found:
        wanted = content.matrix.coherence[:, each["rsp_node"] - 1, each["ref_node"] - 1]
        np.testing.assert_allclose(each["data"], wanted, rtol=1e-7)


def test_time_signals_come_back_bit_for_bit(content: Content, sets: list[dict[str, Any]]) -> None:
    for number in content.files:
        record = content.shot(number)
        found = of_kind(sets, 1, f"shot {number}")
        assert [each["id1"].split()[3].rstrip(",") for each in found] == list(record.names)
        for each, unit, signal in zip(found, record.units, record.data.T, strict=True):
            np.testing.assert_array_equal(each["data"].astype(np.float32), signal)
            assert each["ordinate_axis_units_lab"] == unit
            assert each["abscissa_inc"] == pytest.approx(1 / 44_100, rel=3e-6)
            assert each["id5"].startswith("44100 samples/s exactly")


def test_the_reference_is_there_beside_the_shots(content: Content, sets: list[dict[str, Any]]) -> None:
    found = of_kind(sets, 1, ", reference")
    assert [each["rsp_node"] for each in found] == [1, 2]
    np.testing.assert_allclose(found[1]["data"], content.reference[:, 1], rtol=1e-7)


def test_a_spectrum_adds_up_to_the_mean_square(content: Content, sets: list[dict[str, Any]]) -> None:
    record = content.shot(2)
    heard = record.select(["response_1"]).data[content.lead : content.lead + content.frames, 0]
    (found,) = of_kind(sets, 2, "response_1, shot 2")
    assert found["data"].sum() == pytest.approx(np.mean(heard.astype(float) ** 2), rel=2e-3)  # all but above 650 Hz
    assert found["abscissa_inc"] == pytest.approx(1.0)
    assert not of_kind(sets, 2, "drive")


def test_a_sine_on_a_line_has_half_its_amplitude_squared_there() -> None:
    sine = 3 * np.sin(2 * np.pi * 50 * np.arange(1000) / 1000)
    frequency, square = auto_spectrum(sine, 1000.0, 500.0)
    assert square[frequency == 50.0] == pytest.approx(4.5)
    assert square.sum() == pytest.approx(4.5)
    _, square = auto_spectrum(np.full(1000, 2.0), 1000.0, 500.0)
    assert square[0] == pytest.approx(4.0)


def test_the_records_stand_in_their_columns(content: Content, tmp_path: Path) -> None:
    """For readers that count columns, as the format has it."""
    write_uff(tmp_path / "run.uff", content)
    lines = (tmp_path / "run.uff").read_bytes().split(b"\n")[:13]
    assert [lines[0], lines[1][:6]] == [b"    -1", b"    58"]
    assert [int(lines[7][a:b]) for a, b in ((0, 5), (5, 15), (15, 20), (20, 30), (41, 51), (51, 55), (66, 76))] == [
        4, 0, 1, 0, 1, 1, 1
    ]  # fmt: skip
    assert lines[7][31:41].strip() == b"RESPONSE"
    assert all(line.strip() for line in lines[2:7])  # ID lines may not be blank
    assert max(map(len, lines)) <= 80


def test_a_far_field_sensor_goes_along_as_a_pressure(content: Content, tmp_path: Path) -> None:
    write_uff(tmp_path / "run.uff", replace(content, files=with_pressure(content, tmp_path)))
    (found,) = of_kind(pyuff.UFF(str(tmp_path / "run.uff")).read_sets(), 1, "far_field_1, shot 0")
    assert (found["ordinate_spec_data_type"], found["ordinate_axis_units_lab"]) == (15, "Pa")
    assert (found["rsp_ent_name"], found["rsp_node"], found["rsp_dir"]) == ("FAR_FIELD", 1, 0)


@pytest.mark.skipif(not (REAL / "uff58").is_dir(), reason="no files of other programs here")
def test_a_time_signal_is_laid_out_as_an_analyser_writes_it(sets: list[dict[str, Any]]) -> None:
    real = pyuff.UFF(str(REAL / "uff58" / "Sample_UFF58b_bin.uff")).read_sets(0)
    ours = of_kind(sets, 1)[0]
    same = (
        "func_type", "binary", "n_ascii_lines", "fp_format", "abscissa_spacing", "abscissa_spec_data_type",
        "abscissa_axis_lab", "abscissa_axis_units_lab", "load_case_id", "ref_ent_name", "ref_node", "ref_dir",
        "orddenom_spec_data_type", "z_axis_spec_data_type", "orddenom_axis_lab",
    )  # fmt: skip
    assert {name: ours[name] for name in same} == {name: real[name] for name in same}
    assert ours["n_bytes"] == 8 * ours["num_pts"]
    assert real["n_bytes"] == 4 * real["num_pts"]
