"""A run as MCAP and as Parquet, read back by mcap, protobuf and pyarrow."""

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from tests.rigkit.export.read_mcap import attachments, read_mcap
from tests.vibractl.export.exported_run import recorded_run, with_pressure
from vibractl.export.content import Content, read_content
from vibractl.export.run import export_run


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return read_content(recorded_run(tmp_path_factory.mktemp("run")))


@pytest.mark.slow
def test_the_shots_come_back_from_mcap_bit_for_bit_with_their_units(content: Content, tmp_path: Path) -> None:
    (file,) = export_run(content.path, ("mcap",), tmp_path / "shots.mcap").files
    found = read_mcap(file, "float64")
    assert list(found) == ["/reference", "/shot-0000", "/shot-0002"]
    assert found["/reference"].data.tobytes() == content.reference.tobytes()
    for number in content.files:
        record = content.shot(number)
        back = found[f"/shot-{number:04d}"]
        assert (back.names, back.units, back.rate) == (record.names, record.units, record.rate)
        np.testing.assert_array_equal(back.data.astype("float32"), record.data)
        assert back.provenance["rig"] == "simulated-vibrator"
    kept = attachments(file)
    assert set(kept) == {"config.toml", "model.h5", "events.jsonl", "qc.csv", "summary.json"}
    assert kept["config.toml"] == (content.path / "config.toml").read_bytes()


def test_the_shots_and_the_responses_come_back_from_parquet(content: Content, tmp_path: Path) -> None:
    files = export_run(content.path, ("parquet",), tmp_path).files
    names = ["responses", "reference", "shot-0000", "shot-0002"]
    assert [file.name for file in files] == [f"{name}.parquet" for name in names]
    responses = pyarrow.parquet.read_table(files[0])
    np.testing.assert_array_equal(responses["frequency"].to_numpy(), content.matrix.frequency)
    real, imaginary = (responses[f"G_2_1_{part}"].to_numpy() for part in ("re", "im"))
    np.testing.assert_array_equal(real + 1j * imaginary, content.matrix.response[:, 1, 0])
    assert responses.field("G_2_1_variance").metadata[b"unit"] == b"(m/s^2/V)^2"
    shot, record = pyarrow.parquet.read_table(files[-1]), content.shot(2)
    for name, values in zip(record.names, record.data.T, strict=True):
        np.testing.assert_array_equal(shot[name].to_numpy(), values)
    said = json.loads(shot.schema.metadata[b"vibrostage"])
    assert (said["rate"], said["provenance"]["shot"]) == (44_100.0, "2")


@pytest.mark.slow
def test_a_hydrophone_goes_along_as_a_pressure(content: Content, tmp_path: Path) -> None:
    (content.path / "shots" / "0003.wav").write_bytes(with_pressure(content, tmp_path)[0].read_bytes())
    try:
        export_run(content.path, ("parquet", "mcap"), tmp_path / "out", "3")
    finally:
        (content.path / "shots" / "0003.wav").unlink()
    table = pyarrow.parquet.read_table(tmp_path / "out" / "shot-0003.parquet")
    assert table.field("far_field_1").metadata[b"unit"] == b"Pa"
    assert read_mcap(tmp_path / "out" / "run.mcap", "float32")["/shot-0003"].units[-1] == "Pa"
