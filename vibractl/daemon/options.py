"""What the vibrator's procedures may be begun with."""

from rigkit.config import Section, setting
from vibractl.reference_forms import choices

NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$"
_NAME_OR_NONE = r"^([A-Za-z0-9][A-Za-z0-9._-]{0,79})?$"


class RunOptions(Section):
    """A run."""

    run: str = setting("", "", "name of its folder; empty for date and time", pattern=_NAME_OR_NONE)
    resume: bool = setting(False, "", "continue the run of that name")
    model: str = setting("model.h5", "", "model file in the data folder", pattern=NAME)
    reference: str = setting("", "", choices("a file in the data folder"))
    shots: int = setting(0, "shots", "shots in all; 0 for session.shots", ge=0, le=100_000)
    watch: bool = setting(False, "", "reidentify bands that diverge, during the run")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from what the model or the run was made with")


class CalibrationOptions(Section):
    """A calibration."""

    model: str = setting("model.h5", "", "model file to write in the data folder", pattern=NAME)
    again: bool = setting(False, "", "measure again; the earlier result is renamed with its date")
    recompute: bool = setting(False, "", "compute again from the recordings that are there, with their settings")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from those that an unfinished one began with")
