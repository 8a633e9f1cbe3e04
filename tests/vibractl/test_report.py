"""Tests of the report of a run: whole runs of several kinds, and that its figures show what was recorded."""

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from ctlblocks import recording
from ctlblocks.recording import Recording
from vibractl.config import Limits, RigConfig
from vibractl.figures.drive import extremes, headroom
from vibractl.figures.lines import SPANS, draw_envelope, largest_by_span
from vibractl.figures.result import read_result
from vibractl.figures.spectrogram import spectrogram_plot
from vibractl.figures.tracking import tracking_plot
from vibractl.model_file import write_model
from vibractl.report import run_report, shot_table
from vibractl.run_setup import create
from vibractl.session import Session
from vibractl.transfer_matrix import TransferMatrix

SIDES = np.array([[10.0, 2.0], [-1.0, 8.0]])
"""m/s^2 per V at every frequency, from coils to sides."""


def run_folder(path: Path, shots: int, **tables: dict[str, object]) -> Path:
    """Make the folder of a run on a vibrator without dynamics, but with overtones."""
    frequency = np.arange(15.0, 651.0)
    response = np.broadcast_to(SIDES + 0j, (len(frequency), 2, 2))
    known = np.full(response.shape, 1e-4), np.full(response.shape, 0.999)
    rig = {"rig": "simulated-vibrator", "date": "2015-05-01T12:00:00+00:00"}
    write_model(path / "model.h5", TransferMatrix(frequency, response, *known, rig))
    config = RigConfig.model_validate({"reference": {"signal": "chirp:40:90:1"}} | tables)
    folder, made = create(path / "run", config, path / "model.h5")
    learner = made.learner()
    for shot in range(shots):
        drive = learner.drive.astype(float)
        learner.response[:] = ((drive + 0.1 * drive**2) @ SIDES.T).astype(np.float32)
        data = np.column_stack((learner.drive, learner.response, 0 * learner.drive[:, :1])).astype(np.float32)
        names, units = ("drive_1", "drive_2", "response_1", "response_2", "loopback"), ("V", "V", "m/s^2", "m/s^2", "1")
        about = {"rig": "simulated-vibrator", "residual": "0.01"}
        file = folder.shot(shot).with_suffix(f".{config.session.recording}")
        recording.write(file, Recording(names, units, config.audio.rate, data, about))
        learner.advance()
    with folder:
        if shots:
            folder.event("discarded", {"shot": 0, "attempt": 1, "reason": "an input xrun"})
        Session(folder, made).summary()
    return folder.path


@pytest.fixture(scope="module")
def mimo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a run of four shots on both sides."""
    return run_folder(tmp_path_factory.mktemp("mimo"), 4, learning={"gains": (0.9,)})


@pytest.mark.slow
def test_a_run_on_both_sides_is_reported_whole(mimo: Path) -> None:
    figures = run_report(mimo)
    page = (mimo / "report.html").read_text(encoding="utf-8")
    titles = re.findall("<h2>(.*?)</h2>", page)
    assert titles == [
        "Spectrograms", "Spectra", "Learning", "Tracking", "Overtones and phase", "Drives", "Model", "Shots", "Events"
    ]  # fmt: skip
    assert figures["shots"] == 4
    assert f"{figures['iae_ratio'][1]:.3g}" in page
    assert f"{abs(figures['worst_line_db']):.1f} dB under the limit" in page
    assert "4, 1 discarded" in page
    assert "2015-05-01" in page
    assert "nan" not in page.lower().split("<section")[0]
    assert not list(mimo.glob(".*tmp*"))


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "tables",
    [
        {"session": {"recording": "csv"}, "learning": {"side": 2}},
        {"reference": {"signal": "sine:24:1"}, "learning": {"side": 1}},
    ],
    ids=["one shot of side 2 as CSV", "one shot of a sine"],
)
def test_a_run_of_one_shot_and_one_side_is_reported(tmp_path: Path, tables: dict[str, dict[str, object]]) -> None:
    path = run_folder(tmp_path, 1, **tables)
    figures = run_report(path, tmp_path / "png")
    side = tables["learning"]["side"]
    page = (path / "report.html").read_text(encoding="utf-8")
    assert figures["iae_ratio"] == [1.0]
    assert f"IAE of side {side}" in page
    assert f"IAE of side {3 - int(str(side))}" not in page
    assert f"coil {side}, shot 0" in page
    assert len(list((tmp_path / "png").glob("*.png"))) == 12


def test_a_run_without_a_shot_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    path = run_folder(tmp_path, 0)
    with pytest.raises(ValueError, match="0 shots are recorded and 0 judged, must be at least 1"):
        run_report(path)
    assert not (path / "report.html").exists()


def test_a_shot_that_is_not_judged_yet_is_left_out(tmp_path: Path) -> None:
    path = run_folder(tmp_path, 3)
    lines = (path / "qc.csv").read_text().splitlines(keepends=True)
    (path / "qc.csv").write_text("".join(lines[:3]))
    result = read_result(path)
    assert [len(result.rows), result.last.number] == [2, 1]


def test_the_spectrogram_shows_overtones_first_and_is_dark_but_for_the_chirp_in_the_end(mimo: Path) -> None:
    figure = spectrogram_plot(read_result(mimo)).figure
    for number, axes in enumerate(figure.axes[:4]):
        (image,) = axes.get_images()
        level = np.asarray(image.get_array())
        overtones = level[level.shape[0] * 130 // 650 :]
        assert image.get_clim() == (-40.0, 0.0)
        assert overtones.max() < -40 if number % 2 else overtones.max() > -30
        assert level.max() == pytest.approx(0.0, abs=3.0)


def test_the_tracking_figure_shows_the_recorded_response_beside_the_reference(mimo: Path) -> None:
    result = read_result(mimo)
    axes = tracking_plot(result).figure.axes[1]
    response, reference = (line.get_ydata() for line in axes.get_lines())
    start = round(axes.get_lines()[0].get_xdata()[0] * result.rate)  # type: ignore[arg-type, index]
    first = result.made.shot.lead // 4 + start
    recorded = result.last.response[first * 4 : (first + len(np.asarray(response))) * 4 : 4, 0]
    np.testing.assert_allclose(np.asarray(response), recorded, atol=0.02)
    assert np.abs(np.asarray(reference)).max() == pytest.approx(10.0, rel=0.02)


def test_an_envelope_keeps_the_one_sample_that_stands_out() -> None:
    axes = Figure().subplots()
    signal = np.zeros(100_000)
    signal[61_803] = -5.0
    draw_envelope(axes, np.arange(100_000) / 44_100, signal, {"color": "black"})
    corners = axes.collections[0].get_paths()[0].vertices
    assert np.asarray(corners)[:, 1].min() == -5.0
    assert len(np.asarray(corners)) < 3 * SPANS


def test_a_line_that_stands_out_is_drawn_at_its_own_frequency() -> None:
    frequency, size = np.arange(5_000) * 0.2, np.ones(5_000)
    size[1_234] = 7.0
    place, largest = largest_by_span(frequency, size)
    assert place[np.argmax(largest)] == frequency[1_234]
    assert largest.max() == 7.0


def test_a_drives_extremes_are_those_of_a_sine() -> None:
    rate, seconds = 44_100.0, 3.0
    drive = 2 * np.sin(2 * np.pi * 50 * np.arange(round(seconds * rate)) / rate)
    peak, slew, rms = extremes(drive, Limits(), rate)
    assert peak == pytest.approx(2.0, rel=1e-4)
    assert slew == pytest.approx(2 * 2 * np.pi * 50, rel=1e-3)
    assert rms == pytest.approx(np.sqrt(2 * (1 - np.exp(-seconds))), rel=5e-3)
    assert headroom(0.9, 9.0) == pytest.approx(20.0)


def test_the_shots_table_has_a_row_a_shot_and_a_dash_for_what_is_not_known(mimo: Path) -> None:
    table = shot_table(read_result(mimo))
    repeat = table.head.index("repeat, dB")
    assert [row[0] for row in table.rows] == ["0", "1", "2", "3"]
    assert table.rows[0][repeat] == "–"
    assert float(table.rows[1][repeat]) < 0
