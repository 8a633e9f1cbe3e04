"""A run in the formats of other programs, every file whole or not there."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rigkit import atomic
from rigkit.export.mcap_file import write_mcap
from rigkit.export.optional import refuse_missing
from vibractl.export.content import Content, read_content
from vibractl.export.csv import write_csv
from vibractl.export.mat import write_mat
from vibractl.export.parquet import write_parquet
from vibractl.export.segy import write_segy
from vibractl.export.uff import write_uff

FOLDER = "export"
"""Within the run folder, unless another place is named."""
BESIDE = ("config.toml", "model.h5", "events.jsonl", "qc.csv", "summary.json")
"""Files of a run that go along whole where a format takes them."""


@dataclass(frozen=True)
class Exported:
    """What was written of a run.

    Parameters
    ----------
    files : tuple of Path
    over : tuple of Path
        Those that were there already, and have been written over.
    shots : tuple of int
        Counted from 0.
    recorded : int
        Shots that there were.
    """

    files: tuple[Path, ...]
    over: tuple[Path, ...]
    shots: tuple[int, ...]
    recorded: int


def write_mcap_of_run(path: Path, content: Content) -> None:
    """Write reference and shots as MCAP, in place."""
    topics = ((f"/{name}", record) for name, record in content.recordings())
    beside = [file for name in BESIDE if (file := content.path / name).is_file()]
    write_mcap(path, topics, content.about, beside)


_WRITERS: dict[str, tuple[str, Callable[[Path, Content], None]]] = {
    "uff": ("run.uff", write_uff),
    "segy": ("run.sgy", write_segy),
    "mat": ("run.mat", write_mat),
    "mcap": ("run.mcap", write_mcap_of_run),
}
_FOLDERS: dict[str, Callable[[Path, Content], list[Path]]] = {"csv": write_csv, "parquet": write_parquet}
FORMATS = (*_WRITERS, *_FOLDERS)
SUFFIXES = {"uff": (".uff", ".unv", ".bin"), "segy": (".sgy", ".segy"), "mat": (".mat",), "mcap": (".mcap",)}
"""What the name of a single file may end in."""


def export_run(
    path: Path, formats: Sequence[str] = FORMATS, out: Path | None = None, shots: str | None = None
) -> Exported:
    """Write a run folder in other formats.

    Parameters
    ----------
    path : Path
        Run folder of at least one shot; it may belong to a run that goes on.
    formats : sequence of str
        Of `FORMATS`.
    out : Path, optional
        A folder, made if absent; or the file, for one format that is one file, with its suffix.
    shots : str, optional
        As for `read_content`.

    Raises
    ------
    ValueError : no such format, place or shot, a damaged run, or a package that is not installed.
    """
    for name in formats:
        if name not in FORMATS:
            raise ValueError(f"--format is {name!r}, must be one of {', '.join(FORMATS)}")
    single = out is not None and out.suffix.lower() in [suffix for each in SUFFIXES.values() for suffix in each]
    if out is not None and single and (len(formats) > 1 or out.suffix.lower() not in SUFFIXES.get(formats[0], ())):
        raise ValueError(f"--out is {out}, must be a folder for --format {', '.join(formats)}")
    content = read_content(path, shots)
    refuse_missing(formats)
    with atomic.folder(path / FOLDER if out is None else out.parent if single else out) as folder:
        written: list[Path] = []
        there = set(folder.iterdir())
        for name in formats:
            if name in _FOLDERS:
                written += _FOLDERS[name](folder, content)
                continue
            file, write = _WRITERS[name]
            target = out if single and out is not None else folder / file
            with atomic.replacing(target) as temporary:
                write(temporary, content)
            written.append(target)
    over = tuple(file for file in written if file in there)
    return Exported(tuple(written), over, tuple(content.files), content.recorded)
