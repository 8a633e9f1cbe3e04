"""What every procedure of the cell may be begun with."""

from collections.abc import Iterator

from rigkit.config import Section, setting

NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$"
MODEL = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,76}\.h5$"
MODEL_OR_NONE = r"^([A-Za-z0-9][A-Za-z0-9._-]{0,76}\.h5)?$"
NAME_OR_NONE = r"^([A-Za-z0-9][A-Za-z0-9._-]{0,79})?$"


class Paced(Section):
    """Simulated, in real time or not."""

    paced: bool = setting(False, "", "in real time; else the simulation goes as fast as it can")

    def led_to(self, data: str) -> Iterator[Section]:  # noqa: ARG002 (to none)
        """Read the rig files that these options lead to in the data folder, beside the daemon's own."""
        return iter(())

    def refuse_live(self, key: str, is_live: bool) -> None:
        """Refuse to be paced where `key` has the procedure live, by ValueError: the robot's reports are the clock."""
        if self.paced and is_live:
            raise ValueError(f"paced is true, must be false where {key} is true: the robot is the clock")


class Run(Paced):
    """A run of any kind."""

    run: str = setting("", "", "name of its folder; empty for date and time", pattern=NAME_OR_NONE)
