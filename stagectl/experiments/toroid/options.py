"""What the toroid may be begun with under the daemon."""

from collections.abc import Iterator
from typing import Literal

from rigkit import config as rig_file
from rigkit.config import Section, setting
from rigkit.service.paths import data_file
from stagectl.config import StageConfig
from stagectl.daemon.cell_options import Run


class CellOptions(Run):
    """The toroid in steel."""

    setup: Literal["A", "B", "C", "C-fixed", "all"] = setting("C", "", "robot, tracker, stage: which of them correct")
    stage: str = setting("", "", "the stage's own rig file in the data folder; empty for the usual stage")
    live: bool = setting(False, "", "on robot, tracker and stage: the workpiece near the path, nobody in the cell")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what the stage's models were measured with")

    def led_to(self, data: str) -> Iterator[Section]:
        """Read the stage's own rig file."""
        if self.stage:
            yield rig_file.load(data_file(data, "stage", self.stage), StageConfig, as_written=True)
