"""A folder of another program's run is named for what it is, before its settings are read as a vibrator's."""

from pathlib import Path

import pytest

from rigkit import config as rig_file
from rigkit.origin import RUN, Origin
from rigkit.run_folder import CONFIG
from stagectl.robot.config import CellConfig
from tests.commands.running import MAINS

OTHER = "its run.json has kind 'step responses', must be one of vibrator run, imported vibrator run"


@pytest.mark.parametrize("words", [["report"], ["replay"], ["export"], ["run", "--resume"]])
def test_it_is_refused_in_one_line_and_nothing_changes(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / CONFIG).write_text(rig_file.dump(CellConfig()))
    Origin.of("step responses", CellConfig()).write(tmp_path / RUN)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    monkeypatch.setattr("sys.argv", ["vibractl", *words, str(tmp_path)])
    assert MAINS["vibractl"]() == 2
    assert capsys.readouterr().err == f"error: {tmp_path}: {OTHER}\n"
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir() if file.name in before} == before
