"""Runs of the stage read back from their folders: what they were made of, and what would be made of them now."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rigkit import config as rig_file
from rigkit.experiment.kept import told
from rigkit.origin import RUN, read_origin
from rigkit.run_folder import CONFIG, read_events
from stagectl.config import StageConfig
from stagectl.experiments.piezo.held_reference import RESUMED
from stagectl.experiments.piezo.prefilter_file import PREFILTER
from stagectl.experiments.piezo.setup import Setup, setup, with_prefilters
from stagectl.link.config import GONE
from stagectl.stage.loop_parameters import loops_from_json


def model_name(axis: str) -> str:
    """Return how the copy of an axis' model is called in a run's folder."""
    return f"model-{axis}.h5"


def setup_of(path: Path, settings: Sequence[str] = ()) -> Setup:
    """Return the setup of a run from its folder, with settings laid over its rig file.

    Raises
    ------
    ValueError : that is no whole run's, or settings do not fit.
    """
    if not (path / CONFIG).is_file():
        raise ValueError(f"{path}/ is not the folder of a run: it has no {CONFIG}")
    config = _config_of(path, settings)
    files = [path / model_name(axis) for axis in config.stage.axes]
    made = setup(config, [] if config.session.live and not files[0].exists() else files)
    return _as_it_went(path, made)


def setup_as_run(path: Path) -> Setup:
    """Return what the controllers of a run are made of: the loops that were used, and nothing is designed.

    Raises
    ------
    ValueError : as of `setup_of`; folders of before, which do not say their loops, are set up by that.
    """
    origin = read_origin(path / RUN)
    kept = origin.designed.get("loops", {}) if origin else {}
    if not kept:
        return setup_of(path)
    config = _config_of(path)
    loops = loops_from_json(config.stage.axes, kept, config.stage.rate)
    made = Setup(config, (), (), loops=tuple(loops))
    given = config.deflection.prefilter
    return _as_it_went(path, with_prefilters(made, Path(given)) if given else made)


def ended_before(path: Path) -> frozenset[str]:
    """Return the recordings whose end is told as versions did that had no parts."""
    ends = (event for event in read_events(path) if event["event"] == "recorded")
    return frozenset(event["recording"] for event in ends if "recording" in event)


def _config_of(path: Path, settings: Sequence[str] = ()) -> StageConfig:
    """Return the rig file of a run, its files those in its folder."""
    config = rig_file.load(path / CONFIG, StageConfig, settings, gone=GONE)
    if config.inner.hysteresis:
        kept = tuple(str(path / f"hysteresis-{axis}.h5") for axis in config.stage.axes)
        config = config.model_copy(update={"inner": config.inner.model_copy(update={"hysteresis": kept})})
    return config


def _as_it_went(path: Path, made: Setup) -> Setup:
    """Return a setup with what was learned and held in a run."""
    if (path / PREFILTER).is_file():
        made = with_prefilters(made, path / PREFILTER)
    held = [event["samples"] for event in read_events(path) if event["event"] == RESUMED and "samples" in event]
    ended = told(path, "ended").get("", {}).get("held", 0)
    return replace(made, held=max(ended, held[-1] if held else 0))
