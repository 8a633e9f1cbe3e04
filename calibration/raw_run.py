"""The folder of a model's raw recordings as the folder of a run: locked, with events, whole at any moment."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rigkit import atomic
from rigkit import config as rig_file
from rigkit.config import Section
from rigkit.run_folder import CONFIG, RunFolder


@contextmanager
def raw_run(path: Path, config: Section) -> Iterator[RunFolder]:
    """Make the folder, or take it up again; one in which nothing came goes again.

    Parameters
    ----------
    path : Path
    config : Section
        The whole rig file.

    Raises
    ------
    FolderInUseError : another process is working in it.
    """
    path.mkdir(parents=True, exist_ok=True)
    is_new = not (path / CONFIG).exists()
    if is_new:
        atomic.write(path / CONFIG, rig_file.dump(config))
    with RunFolder.open(path) as folder:
        try:
            yield folder
        finally:
            if is_new and not any(path.rglob("*.wav")):
                folder.withdraw()
