"""What learning to mill may be begun with under the daemon."""

from typing import Literal, Self

from pydantic import model_validator

from rigkit.config import setting
from stagectl.daemon.cell_options import NAME, Run


class IlcOptions(Run):
    """Trials in the air, then in material."""

    resume: bool = setting(False, "", "go on with the run of that name: its settings, task and models")
    method: str = setting("1", "", "1, 2, 3, several as 1,2, or all", pattern=r"^(all|[123](,[123]){0,2})$")
    iterations: int = setting(4, "trials", "in material after the first one, of each method", ge=1, le=50)
    task: Literal["pocket28", "pocket28-deep", "pocket"] = setting("pocket28", "", "pocket is that of [pocket]")
    model: str = setting("milling.h5", "", "model file in the data folder", pattern=NAME)
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what the models or the run were made with")

    @model_validator(mode="after")
    def _names_what_it_goes_on_with(self) -> Self:
        if self.resume and not self.run:
            raise ValueError('run is "", must be the name of the run to go on with, since resume is true')
        return self
