"""A run as CSV, read back by numpy, by this project, and by their own first lines."""

import json
from pathlib import Path

import numpy as np
import pytest

from ctlblocks import recording
from tests.vibractl.export.exported_run import recorded_run
from vibractl.export.content import Content, read_content
from vibractl.export.csv import write_csv


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return read_content(recorded_run(tmp_path_factory.mktemp("run")))


@pytest.fixture(scope="module")
def files(content: Content, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return write_csv(tmp_path_factory.mktemp("csv"), content)


def test_the_files_are_named_by_what_they_hold(files: list[Path]) -> None:
    assert [file.name for file in files] == ["responses.csv", "reference.csv", "shot-0000.csv", "shot-0002.csv"]


def test_the_responses_come_back_by_the_names_of_their_columns(content: Content, files: list[Path]) -> None:
    lines = files[0].read_text().splitlines()
    said, head = json.loads(lines[0].removeprefix("#")), lines[1].split(",")
    table = np.loadtxt(files[0], delimiter=",", skiprows=2)
    assert said["format"] == "RI"
    assert (said["responses"], said["drives"], said["bins"]) == (2, 2, len(table))
    assert said["provenance"]["rig"] == "simulated-vibrator"
    np.testing.assert_array_equal(table[:, head.index("frequency [Hz]")], content.matrix.frequency)
    for output in range(2):
        for drive in range(2):
            name = f"G_{output + 1}_{drive + 1}"
            real, imaginary = (table[:, head.index(f"{name}_{part} [m/s^2/V]")] for part in ("re", "im"))
            np.testing.assert_allclose(real + 1j * imaginary, content.matrix.response[:, output, drive], rtol=1e-8)
            variance = table[:, head.index(f"{name}_variance [(m/s^2/V)^2]")]
            np.testing.assert_allclose(variance, content.matrix.variance[:, output, drive], rtol=1e-8)
            coherence = table[:, head.index(f"{name}_coherence [1]")]
            np.testing.assert_allclose(coherence, content.matrix.coherence[:, output, drive], rtol=1e-8)


def test_the_shots_come_back_bit_for_bit(content: Content, files: list[Path]) -> None:
    for number, file in zip(content.files, files[2:], strict=True):
        read, wanted = recording.read(file), content.shot(number)
        assert (read.names, read.units, read.rate) == (wanted.names, wanted.units, wanted.rate)
        np.testing.assert_array_equal(read.data, wanted.data)
        assert read.provenance["shot"] == str(number)


def test_the_reference_says_where_it_begins(content: Content, files: list[Path]) -> None:
    read = recording.read(files[1])
    np.testing.assert_array_equal(read.data, content.reference)
    assert read.provenance["reference_begins_at_sample"] == "8820"
    assert read.provenance["reference"] == "chirp:40:90:1"
