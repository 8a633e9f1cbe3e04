"""The daemon's own table of a rig file, read by itself: what is wrong elsewhere in the file is in no way of STOP."""

from collections.abc import Sequence
from pathlib import Path

from pydantic import ConfigDict, Field

from rigkit import config as rig_file
from rigkit.config import Section
from rigkit.service.config import Daemon


class _RigFile(Section):
    """A rig file, of which nothing else is looked at."""

    model_config = ConfigDict(extra="ignore")

    daemon: Daemon = Field(default_factory=Daemon)


def daemon_table(config: Path | None, settings: Sequence[str]) -> Daemon:
    """Return the daemon's table of a rig file.

    Parameters
    ----------
    config : Path or None
    settings : sequence of str
        Laid over it, "table.key=value"; those of other tables are passed over.

    Raises
    ------
    ConfigError : the file is no TOML, or its table is wrong.
    """
    own = [text for text in settings if text.partition("=")[0].partition(".")[0].strip() == "daemon"]
    return rig_file.load(config, _RigFile, own).daemon
