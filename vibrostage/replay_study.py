"""A study over recorded runs of the vibrator: each replayed and judged with other settings."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rigkit import config as rig_file
from rigkit.origin import RUN, OriginError, read_origin
from rigkit.retention import stored_runs
from rigkit.study.file import Seeds, Settings, StudyFile
from vibractl.config import RigConfig
from vibractl.run_setup import shot_files

REPLAYED = "vibractl replay {input.1} {settings} --json replayed.json"
JUDGED = "vibractl judge {input.1}/shots/{shot} --config {input.1}/config.toml {settings} --json judged.json"
_KINDS = ("vibrator run", "imported vibrator run")
_NO_NAME = re.compile(r"[^\w.-]+")

FIGURES: dict[str, dict[str, Any]] = {
    "differing": {"file": "replayed.json", "path": "differing", "title": "shots whose drive would be another"},
    "drive": {
        "file": "replayed.json",
        "path": "difference_db",
        "reduce": "max",
        "unit": "dB",
        "title": "largest rms difference of a drive, re the drive",
    },
    "met": {"file": "judged.json", "path": "met", "kind": "yes", "title": "objective met at the last shot"},
    "margin": {
        "file": "judged.json",
        "path": "margin_db",
        "unit": "dB",
        "worst": "lowest",
        "passes": ">= 0",
        "title": "worst bin below the limit, last shot",
    },
}


def replay_study(runs: Path, settings: Sequence[str]) -> StudyFile:
    """Return the study of a folder of runs.

    Parameters
    ----------
    runs : Path
        In which folders of runs lie; those of other rigs, and those without a shot, are left out.
    settings : sequence of str, "table.key=value"
        What is laid over the settings of each; none to see whether each run is rebuilt as it was.

    Raises
    ------
    ValueError : no run of a vibrator is there, or a setting cannot be.
    """
    rig_file.load(None, RigConfig, settings)
    values = {key.strip(): [value.strip()] for key, _, value in (text.partition("=") for text in settings)}
    machines = {name: {"inputs": [str(path.absolute())], "shot": shot} for name, path, shot in _vibrator_runs(runs)}
    if not machines:
        raise ValueError(f"{runs}: there is no run of a vibrator with a recorded shot")
    placeholder = "{settings}" if values else ""
    return StudyFile(
        name="replay",
        purpose=f"Recorded runs of {runs.absolute()}/ with {', '.join(settings) or 'the settings of each'}.",
        commands=tuple(line.replace("{settings}", placeholder) for line in (REPLAYED, JUDGED)),
        seeds=Seeds(first=0, count=1),
        machines=machines,
        settings=Settings(values=values),
        figures=FIGURES,
    )


def _vibrator_runs(runs: Path) -> Iterator[tuple[str, Path, str]]:
    """Find name, folder and last recording of each run, the oldest first."""
    for run in reversed(stored_runs(runs)):
        try:
            origin = read_origin(run.path / RUN)
        except OriginError:
            continue
        files = shot_files(run.path)
        if origin is not None and origin.kind in _KINDS and files:
            yield _NO_NAME.sub("-", run.path.name), run.path, files[-1].name
