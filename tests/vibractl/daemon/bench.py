"""The linear rig under the daemon's authority, without processes or clock."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rigkit import config as rig_file
from rigkit.service.control import Control
from rigkit.service.journal import Journal
from rigkit.service.lease import Lease
from rigkit.service.state import State
from tests.rigkit.service.told_once import check_told_once
from tests.until import until
from tests.vibractl.linear_rig import SETTINGS, linear_model
from vibractl.config import RigConfig
from vibractl.daemon.rig import Vibrator


@dataclass
class Lab:
    """A vibrator, its control and the rig file it reads."""

    rig: Vibrator
    control: Control
    key: str
    file: Path
    data: Path

    @property
    def state(self) -> State:
        return self.control.machine.state

    def edit(self, *overrides: str) -> None:
        """Write the rig file anew, with settings over those of the linear rig."""
        whole = rig_file.load(None, RigConfig, [*SETTINGS, f"daemon.data={self.data}", *overrides])
        self.file.write_text(rig_file.dump(whole))

    def begin(self, procedure: str = "run", **options: Any) -> None:
        if self.state is State.DISARMED:
            self.control.arm(self.key, "a test")
        self.control.begin(self.key, procedure, options, "")

    def ended(self) -> None:
        until(lambda: self.control.settle() or not self.control.machine.busy)
        check_told_once(self.control)

    def until_shot(self, number: int) -> None:
        """Return when so many shots are recorded."""
        until(lambda: self.control.desk is not None and self.control.desk.plain()["done"] >= number)

    def events(self, name: str) -> list[dict[str, Any]]:
        return [entry for entry in self.control.journal.since(0) if entry["event"] == name]


def lab_in(folder: Path, *overrides: str) -> Lab:
    """Return a vibrator that has been calibrated, in a folder."""
    data = folder / "data"
    (data / "runs").mkdir(parents=True)
    linear_model(data)
    lab = Lab.__new__(Lab)
    lab.file, lab.data = folder / "rig.toml", data
    lab.edit(*overrides)
    lab.rig = Vibrator(lambda: rig_file.load(lab.file, RigConfig))
    lab.control = Control(lab.rig, Lease(1e6), Journal(data / "events.jsonl"))
    lab.key = lab.control.take_control("Ada", False)["key"]
    return lab
