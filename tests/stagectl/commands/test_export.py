"""The recordings of a run of the stage as MCAP and Parquet: bit for bit, of whatever lies in the folder."""

import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from ctlblocks import recording
from ctlblocks.recording import Recording
from rigkit.run_folder import RunFolder
from stagectl.__main__ import main
from stagectl.commands.export import export_run
from tests.rigkit.export.read_mcap import attachments, read_mcap

NOISE = np.random.default_rng(4).normal(size=(200, 3))
NAMES = tuple(f"position_{axis}" for axis in "xyz")


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """Make a folder as a run of the cell leaves it: two recordings, at two rates."""
    with RunFolder.create(tmp_path / "run", "[rig]\n") as folder:
        folder.event("started", {})
        folder.quality({"axis": "x"})
        for name, rate in (("C1-stage.wav", 10_000), ("C1-cell.csv", 250)):
            recording.write(folder.path / name, Recording(NAMES, ("m",) * 3, rate, NOISE, {"setup": "C1"}))
    return tmp_path / "run"


def test_every_recording_is_exported_bit_for_bit(run: Path) -> None:
    files = export_run(run)
    assert [file.name for file in files] == ["run.mcap", "C1-cell.parquet", "C1-stage.parquet"]
    found = read_mcap(files[0], "float64")
    assert {topic: (back.rate, back.units) for topic, back in found.items()} == {
        "/C1-cell": (250.0, ("m",) * 3), "/C1-stage": (10_000.0, ("m",) * 3)
    }  # fmt: skip
    assert all(back.data.tobytes() == NOISE.tobytes() for back in found.values())
    assert set(attachments(files[0])) == {"config.toml", "events.jsonl"}
    table = pyarrow.parquet.read_table(files[1])
    np.testing.assert_array_equal(np.column_stack([table[name].to_numpy() for name in NAMES]), NOISE)


@pytest.mark.parametrize("option", ["--file", "--out"])
def test_a_file_may_be_named(option: str, run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By --out as well: so it was before there was --file."""
    place = run.parent / "new" / "x.mcap"
    monkeypatch.setattr("sys.argv", ["stagectl", "export", str(run), "--to", "mcap", option, str(place)])
    assert main() == 0
    assert [path.name for path in place.parent.iterdir()] == ["x.mcap"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--to", "mat"], "--to is 'mat', must be one of mcap, parquet"),
        (["--to", "parquet", "--out", "x.mcap"], "--out is x.mcap, must be a folder for --to parquet"),
        (["--out", "x.mcap"], "--out is x.mcap, must be a folder for --to mcap, parquet"),
        (["--to", "mcap", "--file", "x.csv"], "--file is x.csv, must end in .mcap"),
        (["--out", "x", "--file", "x.mcap"], "--out x and --file x.mcap are given, must be one of them"),
    ],
)
def test_what_cannot_be_exported_is_one_line(
    run: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: str,
) -> None:
    before = sorted(run.iterdir())
    monkeypatch.setattr("sys.argv", ["stagectl", "export", str(run), *arguments])
    assert main() == 2
    assert words in capsys.readouterr().err
    assert sorted(run.iterdir()) == before


def test_a_format_whose_package_is_not_installed_leaves_no_folder_and_no_file_of_another(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.startswith("pyarrow")]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setattr("sys.argv", ["stagectl", "export", str(run)])
    assert main() == 2
    assert "this format needs pyarrow" in capsys.readouterr().err
    assert not (run / "export").exists()


def test_a_folder_without_a_recording_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is not the folder of a run"):
        export_run(tmp_path)
    RunFolder.create(tmp_path / "run", "[rig]\n").close()
    with pytest.raises(ValueError, match="nothing is recorded"):
        export_run(tmp_path / "run")
