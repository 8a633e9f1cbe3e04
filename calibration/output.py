"""What a calibration writes, and whether it may: a new name, an unfinished one's, or one to be made again."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Generic, TypeVar

import typer

from calibration.names import OutputError, oldest, raw_folder, refuse_inputs, set_aside
from rigkit import atomic
from rigkit import config as rig_file
from rigkit.agreement import GOING_ON, Use, agreed, differences
from rigkit.config import Section
from rigkit.config_files import sums_of
from rigkit.json_text import json_text
from rigkit.origin import PARTS, RUN, Origin, read_origin
from rigkit.provenance import now, software

_WAY_OUT = "go back to that, choose another name, or measure again with --again"
Config = TypeVar("Config", bound=Section)

AgainOption = Annotated[
    bool, typer.Option("--again", help="Measure again; the earlier result is renamed with its date.")
]
RecomputeOption = Annotated[
    bool, typer.Option("--recompute", help="Compute again from the existing recordings, with their settings.")
]


@dataclass(frozen=True)
class Wish:
    """What is wanted of a name that is there already.

    Parameters
    ----------
    again : bool
        Measure anew, and set the old one aside.
    recompute : bool
        Compute again from its recordings.
    accept : sequence of str
        Keys that may differ from those that an unfinished one began with.
    """

    again: bool = False
    recompute: bool = False
    accept: Sequence[str] = ()


@dataclass(frozen=True)
class Output(Generic[Config]):
    """What a calibration may write.

    Parameters
    ----------
    out : Path
        Of the model.
    raw : Path
        Folder of the recordings, `out` with the suffix .raw.
    config : Section
        Settings that are in force: those of the recordings, where they are computed again.
    origin : Origin
        Of the recordings, to be written by `begun` where they are new.
    notes : tuple of str
        To be said.
    is_recomputed : bool
        Whether no device may be opened.
    aside : tuple of Path
        What `begun` sets aside.
    """

    out: Path
    raw: Path
    config: Config
    origin: Origin
    notes: tuple[str, ...] = ()
    is_recomputed: bool = False
    aside: tuple[Path, ...] = field(default=())

    @contextmanager
    def begun(self) -> Iterator[None]:
        """Set aside what is to be kept, and say in the folder of recordings what they are made with.

        Where nothing has been recorded when the block ends, the folder goes again.

        Raises
        ------
        FolderInUseError : another process is working in it.
        OSError : the disk.
        """
        if self.aside:
            set_aside(self.out, self.raw, self.aside)
        with atomic.folder(self.raw):
            self.origin.write(self.raw / RUN)
        try:
            yield
        finally:
            if not any(self.raw.rglob("*.wav")):
                (self.raw / RUN).unlink(missing_ok=True)
                atomic.remove_empty([*(each for each in self.raw.glob("*") if each.is_dir()), self.raw])

    def part(self, name: str, config: Config, accept: Sequence[str], use: Use) -> Path:
        """Return a folder for recordings with settings of their own, such as a pose.

        Raises
        ------
        DisagreementError : it was begun with others.
        """
        folder = self.raw / name
        origin = read_origin(folder / RUN)
        if origin is None:
            folder.mkdir(exist_ok=True)
            _begun(self.origin.kind, config).write(folder / RUN)
        else:
            found = differences(origin.settings, config, use, origin.parts)
            agreed(found, accept, f"{folder}/ is unfinished, and began otherwise", _WAY_OUT)
        return folder

    def finish(self) -> None:
        """Say that all is computed and written."""
        replace(self.origin, finished=now()).write(self.raw / RUN)

    @property
    def left(self) -> str:
        """What to say where it was stopped."""
        if any(self.raw.rglob("*.wav")):
            return f"stopped; what is recorded is in {self.raw}/, the same command continues there"
        return "stopped before anything was recorded"

    @property
    def provenance(self) -> dict[str, str]:
        """The words of a model that comes of it: dates are those of the measurement."""
        return provenance(self.config, self.origin.measured, self.origin.parts)


def provenance(config: Section, measured: str, parts: Mapping[str, str]) -> dict[str, str]:
    """Return the words of a model: rig, configuration, software, when it was measured, and when computed.

    Parameters
    ----------
    config : Section
        A whole rig file, with a table `rig`.
    measured : str
        UTC, ISO 8601.
    parts : mapping of str to str
        Checksums of the files that the rig file names, by key.
    """
    name = str(config.rig.name)  # type: ignore[attr-defined]  # every rig file has this table
    words = {"rig": name, "config": rig_file.dump(config), "software": software()}
    words |= {PARTS: json_text(parts)} if parts else {}
    return {**words, "date": measured, "computed": now()}


def output(
    out: Path,
    kind: str,
    config: Config,
    wish: Wish,
    results: Sequence[Path] = (),
    use: Use = GOING_ON,
    is_whole: bool = True,
    inputs: Sequence[Path | None] = (),
) -> Output[Config]:
    """Say what a calibration may write; nothing is written before it is `begun`.

    Parameters
    ----------
    out : Path
        Of the model; `results` are other files that it makes, whose names begin alike.
    kind : str
        Such as "vibrator calibration".
    config : Section
        A whole rig file.
    wish : Wish
    results : sequence of Path
    use : Use
        What an unfinished one must have kept.
    is_whole : bool
        Whether all that is asked for is recorded, where some is.
    inputs : sequence of Path
        Files that are read, and so are none of the results.

    Raises
    ------
    OutputError : not a name for a model, or one that is taken.
    DisagreementError : it is unfinished, and began with other settings or on another rig.
    OriginError : what its recordings say of themselves cannot be read.
    """
    raw = raw_folder(out)
    refuse_inputs([out, *results], inputs)
    there = [path for path in dict.fromkeys((out, *results)) if path.exists()]
    origin = read_origin(raw / RUN)
    recorded = raw.is_dir() and any(raw.rglob("*.wav"))
    if wish.again and wish.recompute:
        raise OutputError("--again measures again and --recompute does not: use one of them")
    if wish.again:
        aside = (*there, *([raw] if raw.exists() else []))
        return Output(out, raw, config, _begun(kind, config), aside=aside)
    if wish.recompute:
        return _recomputed(out, raw, config, kind, origin, recorded)
    if there and not recorded:
        raise OutputError(
            f"{there[0]}: is there already, without its recordings in {raw}/; choose another name, or keep it under "
            "its date and measure with --again"
        )
    if there and is_whole and (origin is None or origin.finished):
        measured = origin.measured if origin is not None else oldest(raw)
        raise OutputError(
            f"{there[0]}: was measured on {measured}, and is finished; --again measures again and renames the earlier "
            "result, --recompute computes it from its recordings, or choose another name"
        )
    if origin is None:
        told = _begun(kind, config)
        return Output(out, raw, config, replace(told, measured=oldest(raw)) if recorded else told)
    return _unfinished(out, raw, config, kind, origin, wish, use)


def _begun(kind: str, config: Section) -> Origin:
    """Return the origin of a calibration that begins now, with what the files hold that its rig file names."""
    return replace(Origin.of(kind, config), parts=sums_of(config))


def _unfinished(
    out: Path, raw: Path, config: Config, kind: str, origin: Origin, wish: Wish, use: Use
) -> Output[Config]:
    if origin.kind != kind:
        raise OutputError(f"{raw}/ is of a {origin.kind}, this is a {kind}; choose another name, or --again")
    found = differences(origin.settings, config, use, origin.parts)
    notes = agreed(found, wish.accept, f"{raw}/ is unfinished, and began otherwise", _WAY_OUT)
    keys = [each.key for each in found if each.is_harmful]
    begun = _begun(kind, config)
    today = replace(origin, settings=begun.settings, parts=begun.parts, finished="").accepting(keys)
    return Output(out, raw, config, today, tuple(notes))


def _recomputed(
    out: Path, raw: Path, config: Config, kind: str, origin: Origin | None, recorded: bool
) -> Output[Config]:
    if not recorded:
        raise OutputError(f"--recompute: {raw}/ holds no recordings")
    if origin is None:
        note = f"{raw}/ does not say what it was recorded with: the settings of now are taken"
        return Output(out, raw, config, replace(_begun(kind, config), measured=oldest(raw)), (note,), True)
    if origin.kind != kind:
        raise OutputError(f"--recompute: {raw}/ is of a {origin.kind}, this is a {kind}")
    if not origin.finished:
        raise OutputError(f"--recompute: in {raw}/ not all is recorded; the same command without it continues")
    then = type(config).model_validate_json(json.dumps(origin.settings))
    note = f"computed again from the recordings of {origin.measured}, with their settings"
    return Output(out, raw, then, origin, (note,), True)
