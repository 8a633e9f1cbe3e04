"""What arming makes ready: the models, the link to a live stage, and the loops once they are wanted."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from rigkit.disk_space import refuse_full
from stagectl.config import StageConfig
from stagectl.link.bus import LinkError
from stagectl.link.stage_link import StageLink
from stagectl.link.tell import Tell, nobody
from stagectl.model_file import read_model
from stagectl.setup import Setup, setup
from stagectl.wire.messages import Fault


class Ready:
    """An armed stage.

    Parameters
    ----------
    config : StageConfig

    Raises
    ------
    ValueError, OSError : models are missing or do not fit, the disk is full, the stage is not heard, or it reports a
        fault; nothing is held.
    """

    def __init__(self, config: StageConfig) -> None:
        data = Path(config.daemon.data)
        refuse_full(data)
        self.config = config
        self.models = _models(config, data)
        for file in self.models:
            read_model(file, rate=config.stage.rate)
        self.tell: Tell = nobody
        """Told of what happens on the link."""
        self._made: Setup | None = None
        self.link: StageLink | None = None
        if config.session.live:
            self.link = self._opened()

    @property
    def is_at_fault(self) -> bool:
        """Whether the link has latched, or the stage reports a fault."""
        return self.link is not None and bool(self.link.reason or self.link.stage_fault is not Fault.NONE)

    def setup(self, config: StageConfig) -> Setup:
        """Return the setup of a run with these settings; the loops are designed at the first one, which takes a while.

        Parameters
        ----------
        config : StageConfig
            Unlike `self.config` in session, reference and deflection at most.
        """
        if self._made is None:
            self._made = setup(self.config, self.models)
        return replace(self._made, config=config)

    def close(self) -> None:
        """Give up the link."""
        if self.link is not None:
            self.link.__exit__()
            self.link = None

    def _opened(self) -> StageLink:
        link = StageLink(self.config.link, self._told).__enter__()
        if link.stage_fault is Fault.NONE:
            return link
        fault = link.stage_fault.name
        link.__exit__()
        raise LinkError(f"the stage reports {fault}; find out why, then: stagectl acknowledge --config ... --by NAME")

    def _told(self, event: str, fields: Mapping[str, Any]) -> None:
        self.tell(event, fields)


def _models(config: StageConfig, data: Path) -> list[Path]:
    """Return the model files in the data folder, one an axis; of a live stage, none where none is there."""
    files = [data / f"stage-{axis}.h5" for axis in config.stage.axes]
    missing = [file for file in files if not file.is_file()]
    if config.session.live and len(missing) == len(files):
        return []
    if missing:
        raise ValueError(f"{missing[0]} is missing: calibrate stage --out {data / 'stage.h5'} makes one for each axis")
    return files
