"""What learning to mill may be begun with under the daemon."""

from collections.abc import Iterator
from typing import Literal, Self

from pydantic import model_validator

from rigkit import config as rig_file
from rigkit.config import Section, setting
from rigkit.run_folder import CONFIG
from rigkit.service.paths import run_path
from stagectl.daemon.cell_options import MODEL_OR_NONE, NAME, Run
from stagectl.robot.config import CellConfig


class IlcOptions(Run):
    """Trials in the air, then in material."""

    resume: bool = setting(False, "", "continue the run of that name with its settings, task and models")
    method: str = setting("1", "", "1, 2, 3, several as 1,2, or all", pattern=r"^(all|[123](,[123]){0,2})$")
    iterations: int = setting(4, "trials", "in material after the first one, of each method", ge=1, le=50)
    task: Literal["pocket28", "pocket28-deep", "pocket"] = setting("pocket28", "", "pocket is that of [pocket]")
    model: str = setting("milling.h5", "", "model file in the data folder", pattern=NAME)
    joints: str = setting(
        "",
        "",
        "joint models in the data folder: the path carries the lost motion of joints that turn around; empty for none",
        pattern=MODEL_OR_NONE,
    )
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what the models or the run were made with")

    @model_validator(mode="after")
    def _names_what_it_goes_on_with(self) -> Self:
        if self.resume and not self.run:
            raise ValueError('run is "", must be the name of the run to go on with, since resume is true')
        if self.resume and self.joints:
            raise ValueError(f'joints is "{self.joints}", must be "" where resume is true: the run has its own')
        return self

    def led_to(self, data: str) -> Iterator[Section]:
        """Read the rig file of the run that is to go on."""
        if self.resume and (file := run_path(data, self.run) / CONFIG).is_file():
            yield rig_file.load(file, CellConfig, as_written=True)
