"""A learning by files alone: what is written, played and recorded, in one folder."""

import sys
from pathlib import Path

import numpy as np
import pytest
import soundfile

from calibration.__main__ import main as calibrate
from ctlblocks import recording
from firmware_sim.__main__ import main as firmware_sim
from rigkit import config as rig_file
from tests.vibractl.linear_rig import linear_config, linear_model
from vibractl.__main__ import main as vibractl
from vibractl.run_setup import create
from vibractl.session import Session

MAINS = {"vibractl": vibractl, "firmware-sim": firmware_sim, "calibrate": calibrate}
KALMAN = ("learning.law=kalman", "learning.gains=[]")


class LabOfFiles:
    """A folder with a rig file and a model, and the programs that are called in it.

    Parameters
    ----------
    path : Path
    monkeypatch, capsys
        pytest's.
    """

    def __init__(self, path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self.path, self._monkeypatch, self._capsys = path, monkeypatch, capsys
        self.config = linear_config(
            *KALMAN, "session.check=false", "simulator.options.noise=-60.0", "simulator.options.nonlinearity=1.0"
        )
        (path / "rig.toml").write_text(rig_file.dump(self.config))
        linear_model(path)
        monkeypatch.chdir(path)

    def call(self, *words: str) -> tuple[int, str]:
        """Return a command's status and all that it says."""
        self._monkeypatch.setattr(sys, "argv", list(words))
        status = MAINS[words[0]]()
        said = self._capsys.readouterr()
        return status, said.out + said.err

    def done(self, *words: str) -> str:
        """Return what a command says that must end well."""
        status, said = self.call(*words)
        assert status == 0, said
        return said

    def refused(self, *words: str) -> str:
        """Return what a command says that must be refused, and must change nothing."""
        before = {each: each.read_bytes() for each in self.path.rglob("*") if each.is_file()}
        status, said = self.call(*words)
        assert status == 2, said
        assert {each: each.read_bytes() for each in self.path.rglob("*") if each.is_file()} == before
        assert said.count("\n") == 1
        return said

    def begin(self) -> None:
        """Write the first drive."""
        self.done(
            "vibractl", "step", "--config", "rig.toml", "--model", "model.h5", "--state", "S.h5", "--out", "0.wav"
        )

    def play(self, shot: int) -> None:
        """Record the response to a drive."""
        words = ("--config", "rig.toml", "--state", "vibrator.h5", "--out", f"heard-{shot}.wav")
        self.done("firmware-sim", "play", f"{shot}.wav", *words)

    def step(self, shot: int) -> None:
        """Learn from it, and write the next drive."""
        self.done("vibractl", "step", *self.recorded(shot), "--state", "S.h5", "--out", f"{shot + 1}.wav")

    @staticmethod
    def recorded(shot: int) -> tuple[str, ...]:
        """Return the options that name a shot's recording."""
        return "--drive", f"{shot}.wav", "--response", f"heard-{shot}.wav"

    def volts(self, shot: int) -> np.ndarray:
        """Return a drive as it was written, float32, V."""
        data, _ = soundfile.read(self.path / f"{shot}.wav", always_2d=True)
        return (data * self.config.audio.output_full_scale).astype(np.float32)

    def run(self, shots: int) -> list[np.ndarray]:
        """Return the drives of a run of the same rig."""
        folder, made = create(self.path / "run", self.config, self.path / "model.h5")
        with folder:
            Session(folder, made).run(shots, lambda *_: None, lambda: False)
        files = [recording.read(folder.shot(number)) for number in range(shots)]
        return [each.select(["drive_1", "drive_2"]).data for each in files]
