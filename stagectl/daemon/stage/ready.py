"""What arming makes ready: the link to a live stage; and the models and loops, once they are wanted."""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from rigkit import config as rig_file
from rigkit.disk_space import refuse_full
from stagectl.config import StageConfig
from stagectl.experiments.piezo.setup import Setup, setup
from stagectl.link.bus import LinkError
from stagectl.link.stage_link import StageLink
from stagectl.link.tell import Tell, nobody
from stagectl.models.model_file import read_model
from stagectl.models.model_origin import refuse_foreign
from stagectl.stage.piezo_pid import pid
from stagectl.wire.messages import Fault

CHOSEN = "stage.toml"
"""In the data folder: the rig file that a calibration has made, with what it has chosen."""


class Ready:
    """An armed stage.

    Parameters
    ----------
    config : StageConfig

    Raises
    ------
    ValueError, OSError : models do not fit, the disk is full, the stage is not heard, or it reports a fault; nothing is
        held.
    """

    def __init__(self, config: StageConfig) -> None:
        data = Path(config.daemon.data)
        refuse_full(data)
        self.config = config
        self.models: list[Path] = []
        for file in filter(Path.is_file, _files(config)):
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

    def setup(self, config: StageConfig, accept: Collection[str] = ()) -> Setup:
        """Return the setup of a run with these settings; the loops are designed at the first one, which takes a while.

        Parameters
        ----------
        config : StageConfig
            Unlike `self.config` in session, reference and deflection at most.
        accept : collection of str
            Keys in which the stage that models were measured on may differ.

        Raises
        ------
        ValueError : models are missing, or were measured with other inner loops.
        DisagreementError : models were measured on a stage that was wired otherwise.
        """
        if self._made is None:
            self.models = _models(self.config)
            self._made = setup(self.config, self.models)
        said = refuse_foreign(self.config, self.models, self._made.models, accept)
        return replace(self._made, config=config, said=tuple(said))

    def take(self, config: StageConfig) -> None:
        """Take over the settings that a calibration has chosen: models and loops are made anew."""
        self.config, self._made = config, None

    @contextmanager
    def lent(self, tell: Tell) -> Iterator[StageLink]:
        """Give the link to a run, which is told of what happens on it; it stays open."""
        assert self.link is not None  # a live stage has it while it is armed
        self.tell = tell
        yield self.link

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


def _files(config: StageConfig) -> list[Path]:
    return [Path(config.daemon.data) / f"stage-{axis}.h5" for axis in config.stage.axes]


def _models(config: StageConfig) -> list[Path]:
    """Return the model files in the data folder, one an axis; of a live stage, none where none is there."""
    files, data = _files(config), Path(config.daemon.data)
    missing = [file for file in files if not file.is_file()]
    if config.session.live and len(missing) == len(files):
        return []
    if missing:
        raise ValueError(
            f"{missing[0]} is missing: the procedure calibrate, or `calibrate stage --out {data / 'stage.h5'}`, makes "
            "one for each axis"
        )
    _refuse_other_loops(config, data / CHOSEN)
    return files


def _refuse_other_loops(config: StageConfig, chosen: Path) -> None:
    """Refuse inner loops other than those that the models were measured with, where a file says which those are."""
    if not chosen.is_file():
        return
    inner = rig_file.load(chosen, StageConfig, as_written=True).inner
    for number, axis in enumerate(config.stage.axes):
        if pid(inner, number) != pid(config.inner, number):
            raise ValueError(
                f"[inner] is not what the models were measured with: axis {axis} has {pid(config.inner, number)}, "
                f"{chosen} has {pid(inner, number)}; start the daemon with that file as --config, or calibrate again"
            )
