"""What a run is made of, in its folder: made new, or put together again to go on, to be replayed or reported."""

import re
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path

from ctlblocks.room import bytes_of, megabytes
from rigkit import config as rig_file
from rigkit import run_origin
from rigkit.agreement import GOING_ON, MEASURED_ELSEWHERE, agreed, differences
from rigkit.disk_space import require
from rigkit.kept_files import kept_files
from rigkit.origin import RUN, read_origin
from rigkit.run_folder import CONFIG, RunFolder
from rigkit.run_origin import changed, going_on, keep_origin
from vibractl.config import RigConfig
from vibractl.fft_plans import Plans
from vibractl.judging import Judging
from vibractl.library.entry import Entry, read_entry, write_entry
from vibractl.loudness import ROOM, at_level, fitting_level, told_level, too_loud
from vibractl.model_file import read_far_field, read_model
from vibractl.model_origin import model_for
from vibractl.reference import is_file
from vibractl.setup import Setup, setup, warm_setup

MODEL, WISDOM, REFERENCE, START = "model.h5", "fftw.wisdom", "reference", "start.h5"
UNCHANGED = GOING_ON.without("characterisation")
"""What a run that goes on must have kept."""
VIBRATOR_RUN = "vibrator run"
IMPORTED = "imported vibrator run"
"""Kind of a run that other software has played and recorded."""
KINDS = (VIBRATOR_RUN, IMPORTED)


def create(
    path: Path,
    config: RigConfig,
    model: Path,
    entry: Entry | None = None,
    shots: int = 0,
    accept: Collection[str] = (),
    fit_amplitude: bool = False,
) -> tuple[RunFolder, Setup]:
    """Check everything a run needs, and then make its folder.

    Parameters
    ----------
    path : Path
        Absent or empty.
    config : RigConfig
    model : Path
        Model file of this rig.
    entry : Entry, optional
        Of the library, to be checked and started from; refused at once where its drive breaks a limit of the guard.
    shots : int
        To be recorded; 0 for `session.shots`.
    accept : collection of str
        Keys in which the rig that the model was measured on may differ.
    fit_amplitude : bool
        Whether the reference is made quieter where its first drive takes more than `loudness.ROOM` of a limit.

    Raises
    ------
    ValueError : settings, model and reference do not fit, a limit is broken, or the folder is in use; nothing is
        written.
    DiskFault : the disk has no room for the shots; nothing is written.
    """
    matrix, notes = model_for(model, config, accept)
    far = read_far_field(model, len(config.audio.far_field_channels))
    if entry is None:
        made, broken = setup(config, matrix, far, plans=Plans.of_user(config.spectrum.backend)), None
        made = _within_limits(made, lambda quieter: setup(quieter, matrix, far, plans=made.plans), fit_amplitude)
    else:
        made, broken = warm_setup(config, matrix, far, entry, Plans.of_user(config.spectrum.backend))
    made, config = replace(made, said=(*notes, *made.said)), made.config
    require_room(path, made, shots or config.session.shots)
    kept, source = with_own_reference(config)
    files = kept_files(kept, ["reference.signal"])
    with RunFolder.filled(path, rig_file.dump(files.config), "`run --resume` goes on with it") as folder:
        folder.take_in(model, MODEL)
        parts = [MODEL, *files.take_into(folder)]
        if source is not None:
            folder.take_in(source, kept.reference.signal)
            parts.append(kept.reference.signal)
        if made.plans.wisdom:
            folder.write(WISDOM, made.plans.wisdom)
        if entry is not None:
            write_entry(folder.path / START, entry)
            parts.append(START)
        keep_origin(folder, VIBRATOR_RUN, files.config, parts, sorted(accept))
        if entry is not None:
            folder.event("library", {"entry": entry.name, "tags": dict(entry.tags), "run": entry.about["run"]})
            if broken is not None:
                folder.event("library_refused", {"entry": entry.name, "limit": str(broken)})
    return folder, made


def _within_limits(made: Setup, again: Callable[[RigConfig], Setup], fit_amplitude: bool) -> Setup:
    """Refuse a first drive that breaks a limit, or make the reference quieter first, so that there is room."""
    config, rate = made.config, made.config.audio.rate
    drive = made.learner().rendered(made.law.start)  # at full level, where a quiet run begins faint
    level = ROOM * fitting_level(drive, config.limits, rate)
    if fit_amplitude and level < 1:
        quieter = at_level(config, level)
        said = f"{told_level(quieter)}, {level:.3g} of that given, so that the first drive takes {ROOM:g} of a limit"
        return replace(_within_limits(again(quieter), again, False), said=(said,))
    if broken := too_loud(drive, config.limits, rate):
        raise ValueError(
            f"the first drive is refused: {broken} ({told_level(config)}); --fit-amplitude takes {level:.3g} of it, "
            "with room to learn as far as the model is right"
        )
    return made


def with_own_reference(config: RigConfig) -> tuple[RigConfig, Path | None]:
    """Return settings as a run's folder has them, and the file of the reference that goes into it, if it is one."""
    if not is_file(config.reference.signal):
        return config, None
    source = Path(config.reference.signal)
    own = config.reference.model_copy(update={"signal": REFERENCE + source.suffix.lower()})
    return config.model_copy(update={"reference": own}), source


def settings_of(path: Path, overrides: tuple[str, ...] = ()) -> RigConfig:
    """Return the settings of a run folder, laid over with others; older ones left the hum in, and had FFTW alone."""
    run_origin.refuse_other_kind(path, KINDS)
    file = path / "config.toml"
    text = file.read_bytes() if file.is_file() else b""
    before = {rb"^mains\b": "quality.mains=false", rb"^\[spectrum\]": "spectrum.backend=fftw"}
    older = [setting for key, setting in before.items() if text and not re.search(key, text, re.MULTILINE)]
    config = rig_file.load(file, RigConfig, (*older, *overrides))
    own = path / config.reference.signal
    if is_file(config.reference.signal) and own.is_file():
        config = config.model_copy(update={"reference": config.reference.model_copy(update={"signal": str(own)})})
    return config


def setup_of(path: Path, overrides: tuple[str, ...] = (), model: Path | None = None) -> Setup:
    """Put the run of a folder together again, with the FFT plans it was made with.

    Raises
    ------
    ValueError : the folder lacks a part, or the parts do not fit.
    """
    if model is None and not (path / MODEL).is_file() and is_imported(path):
        raise ValueError(
            f"{path}/ was imported without a model, and this needs one: import it again with --model FILE, which "
            "`vibractl replay` takes as well"
        )
    config = settings_of(path, overrides)
    plans = Plans.of_run(path / WISDOM, config.spectrum.backend)
    matrix = read_model(model or path / MODEL)
    far = read_far_field(model or path / MODEL, len(config.audio.far_field_channels))
    entry = read_entry(path / START) if config.learning.start == "library" else None
    return setup(config, matrix, far, entry, plans)


def judging_of(path: Path) -> Setup | Judging:
    """Return what the shots of a run folder are judged by: its set-up or, where it was imported without a model, less.

    Raises
    ------
    ValueError : as of `setup_of`.
    """
    if (path / MODEL).is_file() or not is_imported(path):
        return setup_of(path)
    return Judging.of(settings_of(path))


def is_imported(path: Path) -> bool:
    """Whether the run in a folder was played and recorded by other software."""
    origin = read_origin(path / RUN)
    return origin is not None and origin.kind == IMPORTED


def resumed_setup(folder: RunFolder, accept: Collection[str] = ()) -> Setup:
    """Put a run together again that is to go on, if it is what it began as.

    Parameters
    ----------
    folder : RunFolder
    accept : collection of str
        Keys that may have changed since.

    Raises
    ------
    ValueError : the folder lacks a part, or the parts do not fit.
    DisagreementError : settings or parts have changed.
    """
    if is_imported(folder.path):
        raise ValueError(
            f"{folder.path}/ was played by other software and imported, so it is not resumed here: continue with "
            "`vibractl step`, or store its drive with `vibractl library add` and begin with `vibractl run --warm`"
        )
    notes = going_on(folder, _as_written(folder.path), accept, UNCHANGED)
    return replace(setup_of(folder.path), said=tuple(notes))


def refuse_changed(path: Path, accept: Collection[str] = ()) -> list[str]:
    """Refuse a run of which settings or parts have changed since it was made; return what is to be said.

    Parameters
    ----------
    path : Path
        Of the run; nothing is written.
    accept : collection of str
        Keys that may have changed.

    Raises
    ------
    DisagreementError : it says which.
    """
    found = changed(path, _as_written(path), UNCHANGED)
    return agreed(found or [], accept, f"{path}/ has changed since the run was made", "put back what it was made with")


def say_changed(path: Path) -> None:
    """Say, on the standard error, what of a run has changed since it was made."""
    run_origin.say_changed(path, _as_written(path), UNCHANGED)


def _as_written(path: Path) -> RigConfig:
    """Return the settings in a run's folder as they stand there; refuse the folder of another program's run."""
    run_origin.refuse_other_kind(path, KINDS)
    return rig_file.load(path / CONFIG, RigConfig, as_written=True)


def refuse_other_wiring(path: Path, config: RigConfig, accept: Collection[str]) -> None:
    """Refuse to go on with a run on a rig that is wired otherwise than its own settings say.

    Parameters
    ----------
    path : Path
        Of the run.
    config : RigConfig
        Of the rig now.
    accept : collection of str
        Keys that may differ.

    Raises
    ------
    DisagreementError : it says which keys.
    """
    found = differences(settings_of(path).model_dump(mode="json"), config, MEASURED_ELSEWHERE)
    agreed(found, accept, f"{path}/ is of a rig that was wired otherwise", "begin a new run")


def require_room(path: Path, made: Setup | Judging, shots: int) -> None:
    """Refuse, by a `DiskFault`, what the disk cannot hold: so many shots, and a tenth more for what is kept of lines.

    Parameters
    ----------
    path : Path
        Folder of the run; need not exist.
    made : Setup, or Judging without a model
    shots : int
        That are still to be recorded.
    """
    audio = made.config.audio
    sensors = len(audio.response_channels) + len(audio.far_field_channels)
    channels = len(audio.drive_channels) + sensors + 1
    a_shot = bytes_of(made.shot.total, channels, "float32", made.config.session.recording)
    require(path, round(1.1 * shots * a_shot), f"{shots} shots of {megabytes(a_shot)}")


def shot_files(path: Path) -> list[Path]:
    """Return the recordings of a run in order, from shot 0 without a gap."""
    files: list[Path] = []
    while True:
        stem = path / "shots" / f"{len(files):04d}"
        found = [file for suffix in (".wav", ".csv") if (file := stem.with_suffix(suffix)).is_file()]
        if not found:
            return files
        files.append(found[0])
