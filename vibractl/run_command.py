"""`vibractl run`."""

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from rigkit import config as rig_file
from rigkit.agreement import AcceptOption
from rigkit.command import ConfigOption, JsonOption, SetOption, laid_over, print_table, words, write_json
from rigkit.common_options import one_of
from rigkit.progress import progress
from rigkit.run_folder import RunFolder, read_quality
from rigkit.stop import Stopped, stoppable
from vibractl.audio_stream import AudioError
from vibractl.config import RigConfig
from vibractl.learning.kinds_of_law import KINDS
from vibractl.library.command import LibraryOption, TagOption, chosen_entry
from vibractl.loudness import FitOption
from vibractl.quality import Marks
from vibractl.quality_table import floor_said, prefix_of
from vibractl.reference_option import ReferenceOption
from vibractl.report import run_report
from vibractl.run_setup import create, resumed_setup
from vibractl.session import Session


def run_command(
    out: Annotated[Path | None, typer.Option(metavar="RUN/", help="Folder to make for a new run.")] = None,
    model: Annotated[Path | None, typer.Option(metavar="FILE", help="Model file from `calibrate vibrator`.")] = None,
    config: ConfigOption = None,
    reference: ReferenceOption = None,
    shots: Annotated[int | None, typer.Option(help="Total number of shots.")] = None,
    side: Annotated[int | None, typer.Option(help="Drive and control this side only; 0 for all.")] = None,
    watch: Annotated[bool, typer.Option("--watch", help="Reidentify bands that diverge, during the run.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Start at low level, rise as the objective allows.")] = False,
    law: Annotated[
        str | None, typer.Option(help=f"Law of learning: {', '.join(KINDS)}.", autocompletion=one_of(KINDS))
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the simulated vibrator.")] = None,
    fit_amplitude: FitOption = False,
    warm: Annotated[
        str | None, typer.Option(metavar="NAME", help="Start from this entry of the library, or from the nearest.")
    ] = None,
    tag: TagOption = None,
    library: LibraryOption = None,
    resume: Annotated[Path | None, typer.Option(metavar="RUN/", help="Continue a stopped run.")] = None,
    accept: AcceptOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
) -> None:
    """Learn the drive for a reference, shot by shot, and end with a report.

    Example: `vibractl run --config rig.toml --model model.h5 --reference chirp:40:90:5 --shots 30 --out RUN/`
    """
    flags = {"reference.signal": reference, "learning.side": side, "learning.law": law, "simulator.options.seed": seed}
    switches = {"watch.on": watch, "learning.quiet": quiet}
    over = laid_over(settings, {**flags, "session.shots": shots, **switches})
    if resume is not None:
        _refuse_beside(resume, (out, model, config, library, warm, tag, fit_amplitude), over)
        _go_on(resume, shots, accept or [], json)
        return
    if out is None or model is None:
        raise ValueError("a new run needs --model FILE and --out RUN/")
    settled = rig_file.load(config, RigConfig, over)
    entry = chosen_entry(warm, settled, tag, library, accept or [])
    if entry is not None and fit_amplitude:
        raise ValueError("--warm and --fit-amplitude are given, must be one of them: an entry has a level of its own")
    folder, made = create(out, settled, model, entry, accept=accept or [], fit_amplitude=fit_amplitude)
    with folder:
        _begin(Session(folder, made), json)


def _refuse_beside(resume: Path, of_new: Iterable[object], over: list[str]) -> None:
    """Refuse what only a new run takes."""
    if any(of_new) or [text for text in over if not text.startswith("session.shots=")]:
        raise ValueError(f"--resume {resume} has the run's own settings; only --shots and --accept may go with it")


def _begin(session: Session, json: str | None) -> None:
    """Learn from the first shot on; a run that comes to nothing leaves no folder."""
    try:
        _learn(session, session.config.session.shots, json)
    except (AudioError, ValueError, OSError):
        if session.untouched:
            session.folder.withdraw()
        raise


def _go_on(path: Path, shots: int | None, accept: list[str], json: str | None) -> None:
    if shots is not None and shots < 1:
        raise ValueError(f"--shots is {shots}, must be >= 1")
    with RunFolder.open(path) as folder:
        made = resumed_setup(folder, accept)
        session = Session(folder, made, accept=accept)
        _learn(session, made.config.session.shots if shots is None else shots, json)


def _learn(session: Session, shots: int, json: str | None) -> None:
    path = session.folder.path
    sys.stderr.write(session.note)
    with stoppable() as stop, progress("learning", shots, start=session.done) as meter:

        def tell(shot: int, marks: Marks) -> None:
            meter.show(shot + 1, f"shot {shot}: {session.said_of(marks)}")

        if session.done < shots:
            meter.say(f"learning: {shots - session.done} shots of {session.seconds:.1f} s; opening the stream")
        session.run(shots, tell, lambda: stop.made)
    figures = session.summary()
    if stop.made and session.done < shots:
        raise Stopped(f"{session.done} of {shots} shots are recorded; go on with: vibractl run --resume {path}")
    run_report(path)
    _print_shots(path, json)
    met = figures["objective_met_shot"]
    verdict = f"objective met from shot {met} on" if met is not None else "objective not met"
    verdict = f"{verdict}; {session.remark}" if session.remark else verdict
    if hidden := figures["shots_hidden"]:
        verdict = f"{verdict}; the ambience hides it in {hidden} of {figures['shots']} shots"
    what, size = floor_said(figures)
    if met is None and what:
        verdict = f"{verdict}; {what} {size}"
    if figures["full_level_shot"] is None:
        verdict = f"{verdict}; the full level is not reached: the last shot is {read_quality(path)[-1]['reason']}"
    print(f"{verdict}; report: {path / 'report.html'}", file=words(json))
    write_json(json, figures)


def _print_shots(path: Path, json: str | None) -> None:
    rows = read_quality(path)
    prefix = prefix_of(rows)
    sides = sum(key.startswith(f"{prefix}iae_") for key in rows[0])
    head, keys = ["shot", "gain", "verdict"], ["shot", "gain", "verdict"]
    for side in range(1, sides + 1):
        head += [f"worst bin {side}, dB", "at, Hz", f"IAE {side}", f"error {side}, dB"]
        keys += [f"{prefix}{name}_{side}" for name in ("worst_line_db", "worst_line_hz", "iae", "error_db")]
    body = [[_short(row[key]) for key in keys] for row in rows]
    print_table(f"{path}: worst bin against the limit, negative is good", head, body, words(json))


def _short(cell: str) -> str:
    try:
        return cell if cell.isdigit() else f"{float(cell):.4g}"
    except ValueError:
        return cell
