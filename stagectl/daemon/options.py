"""What the stage's procedures may be begun with."""

from typing import Literal

from rigkit.config import Section, setting
from rigkit.service.paths import data_file
from stagectl.config import Reference, StageConfig

_NAME_OR_NONE = r"^([A-Za-z0-9][A-Za-z0-9._-]{0,79})?$"


class Renewed(Section):
    """What may be wanted of a calibration whose name is there already."""

    again: bool = setting(False, "", "measure again; the earlier result is renamed with its date")
    recompute: bool = setting(False, "", "compute again from the recordings that are there, with their settings")
    accept: tuple[str, ...] = setting((), "", "keys that may differ from those that an unfinished one began with")


class _RunOptions(Section):
    """A run of any kind."""

    run: str = setting("", "", "name of its folder; empty for date and time", pattern=_NAME_OR_NONE)
    seconds: float = setting(0.0, "s", "length of the run; 0 for session.seconds", ge=0, le=600)
    accept: tuple[str, ...] = setting((), "", "keys that may differ from those that the models were measured with")


class FollowOptions(_RunOptions):
    """A reference to follow."""

    reference: str = setting("", "", "hold, or a WAV or CSV file in the data folder; empty for reference.signal")
    deflection: bool = setting(False, "", "take the robot's deflection off it, whatever deflection.on is")


class HoldOptions(_RunOptions):
    """A place to stay at."""

    position: tuple[float, ...] = setting(
        (), "m", "where: one for all axes, or one an axis; none for reference.position", max_length=8
    )


class CalibrationOptions(Renewed):
    """Models of the axes, and their loops."""

    axis: str = setting("all", "", "which axis by its name, or all", min_length=1, max_length=40)
    method: Literal["moesp", "n4sid"] = setting("moesp", "", "subspace method")


def asked(config: StageConfig, options: FollowOptions | HoldOptions) -> StageConfig:
    """Return the settings of a run, with what its options lay over them.

    Parameters
    ----------
    config : StageConfig
    options : FollowOptions or HoldOptions

    Raises
    ------
    ValueError, OSError : a position is beyond the travel, or a file is not in the data folder.
    """
    reference, deflection = config.reference, config.deflection
    if isinstance(options, HoldOptions):
        reference = Reference(signal="hold", position=_place(config, options.position))
    else:
        if options.reference == "hold":
            reference = reference.model_copy(update={"signal": "hold"})
        elif options.reference:
            file = data_file(config.daemon.data, "reference", options.reference, ["hold"])
            reference = reference.model_copy(update={"signal": str(file)})
        deflection = deflection.model_copy(update={"on": deflection.on or options.deflection})
    seconds = options.seconds or config.session.seconds
    session = config.session.model_copy(update={"seconds": seconds, "compare": False})
    return config.model_copy(update={"reference": reference, "deflection": deflection, "session": session})


def _place(config: StageConfig, position: tuple[float, ...]) -> tuple[float, ...]:
    low, high = config.limits.travel
    axes = len(config.stage.axes)
    if not position:
        return config.reference.position
    if len(position) not in (1, axes) or not all(low <= value <= high for value in position):
        raise ValueError(
            f"position is {position} m, must be 1 or {axes} numbers within limits.travel {low:g} to {high:g} m"
        )
    return position
